"""Bordered linear systems ``[[H_y, H_lam], [border']] z = (r, rho)``, with the sign of their determinant.

Structured H_y are factored alone and bordered by elimination; near a fold the bordered matrix is factored.
"""

from continuation.linear.banded import Banded
from continuation.linear.dispatch import factor_bordered
from continuation.linear.operator import Operator
from continuation.linear.system import BorderedSystem, SingularError

__all__ = ["Banded", "BorderedSystem", "Operator", "SingularError", "factor_bordered"]
