"""Truncated Taylor arithmetic on numpy arrays: derivatives of functions in plain NumPy."""

from continuation.numbers import Jet, JetDomainError
from continuation.numbers.derivatives import (
    derivative_along,
    jacobian,
    path_series,
    second_derivatives,
    taylor,
    variable,
)

__all__ = [
    "Jet", "JetDomainError", "derivative_along", "jacobian", "path_series", "second_derivatives", "taylor", "variable",
]  # fmt: skip
