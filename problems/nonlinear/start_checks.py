"""Checks of F and of the start."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import Factory

from continuation.arguments.checks import expect
from continuation.arrays import Array, Matrix
from problems.options import finite_vector, quiet

Function = Callable[[Array], Array]
"""R^n -> R^n; complex numbers and jets pass through plain numpy."""

Jacobian = Callable[[Array], Matrix]
"""F', (n, n): any matrix that `continuation.linear` factors."""

Derivative = Callable[[Array, float], tuple[Matrix, Array]]
"""Maps (y, lam) to (H_y, H_lam)."""


def start_vector(a: Any) -> Array:
    """Copy a finite vector, or raise ValueError."""
    return finite_vector("a", a)


def value_at(F: Function, a: Array, jacobian: Jacobian | None) -> Array:
    """F(a); `TypeError` or `ValueError` unless finite, of a's shape, and `jacobian`, if any, gives a matrix (n, n)."""
    expect(callable(F), "F", "a function", F, TypeError)
    value: Any = quiet(F)(a.copy())
    if not isinstance(value, np.ndarray):
        raise TypeError(f"F(a): expected an array of shape {a.shape}, found {type(value).__name__}")
    expect(value.shape == a.shape, "F(a)", f"shape {a.shape}, that of a", value.shape)
    if jacobian is not None:
        expect(callable(jacobian), "jacobian", "a function", jacobian, TypeError)
        shape = getattr(quiet(jacobian)(a.copy()), "shape", None)
        expect(shape is not None, "jacobian(a)", "a matrix with a shape", shape, TypeError)
        expect(shape == (a.size, a.size), "jacobian(a)", f"shape {(a.size, a.size)}", shape)
    return finite_vector("F(a)", value)


VALUE: Any = Factory(lambda self: value_at(self.F, self.a, self.slope), takes_self=True)
"""The default of a field: F(a), after the checks."""


def start(self: Any) -> tuple[Array, float]:
    """The point a at lam = 1."""
    return self.a.copy(), 1.0
