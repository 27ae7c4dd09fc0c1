"""Bordered linear systems ``[[H_y, H_lam], [border']] z = (r, rho)``, with the sign of their determinant.

A structure factors H_y alone, and block elimination borders it, with a refinement that knows when it is not accurate:
next to a fold, where H_y is useless, the whole matrix is factored instead. Dense matrices are factored whole at once.
How near a matrix is to singular, and along which vectors, a border tells as well (`nullspace`).
"""

from continuation.linear.banded import Banded
from continuation.linear.dispatch import factor_bordered
from continuation.linear.operator import Operator
from continuation.linear.superlu import permutation_sign
from continuation.linear.symmetric import Symmetric
from continuation.linear.system import BorderedSystem, SingularError

__all__ = ["Banded", "BorderedSystem", "Operator", "SingularError", "Symmetric", "factor_bordered", "permutation_sign"]
