"""Checks of F and of the start."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from continuation.arrays import Array, Matrix
from problems.options import finite_vector, quiet

EQUATIONS = "nonlinear equations F(x) = 0"

Function = Callable[[Array], Array]
"""R^n -> R^n; complex numbers and jets pass through plain numpy."""

Jacobian = Callable[[Array], Matrix]
"""F', (n, n): any matrix that `continuation.linear` factors."""


def require_callable(name: str, value: Any) -> None:
    """Raise TypeError unless `value` is callable."""
    if not callable(value):
        raise TypeError(f"{name}: expected a function, found {type(value).__name__}")


def start_vector(a: Any) -> Array:
    """Copy a finite vector, or raise ValueError."""
    return finite_vector("a", a)


def value_at(F: Function, a: Array) -> Array:
    """F(a), finite, of a's shape; else `TypeError` or `ValueError`."""
    require_callable("F", F)
    value: Any = quiet(F)(a.copy())
    if not isinstance(value, np.ndarray):
        raise TypeError(f"F(a): expected an array of shape {a.shape}, found {type(value).__name__}")
    if value.shape != a.shape:
        raise ValueError(f"F(a): expected shape {a.shape}, that of a, found {value.shape}")
    return finite_vector("F(a)", value)


def check_jacobian_shape(jacobian: Jacobian, a: Array) -> None:
    """Raise TypeError unless `jacobian` returns a matrix, ValueError if not (n, n)."""
    require_callable("jacobian", jacobian)
    shape = getattr(quiet(jacobian)(a.copy()), "shape", None)
    if shape is None:
        raise TypeError("jacobian(a): expected a matrix, found an object without a shape")
    if shape != (a.size, a.size):
        raise ValueError(f"jacobian(a): expected shape {(a.size, a.size)}, found {shape}")
