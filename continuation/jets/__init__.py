"""Truncated Taylor arithmetic on numpy arrays: series and derivatives of functions written in plain numpy."""

from continuation.jets.array import Jet
from continuation.jets.calculus import (
    directional_derivatives,
    evaluate,
    jacobian,
    path_series,
    second_derivatives,
    taylor,
    variable,
)
from continuation.jets.dispatch import FUNCTIONS
from continuation.jets.functions import RULES
from continuation.jets.series import JetDomainError

__all__ = [
    "Jet", "JetDomainError", "directional_derivatives", "evaluate", "jacobian", "path_series",
    "second_derivatives", "taylor", "variable",
]  # fmt: skip

FUNCTIONS.update(RULES)
