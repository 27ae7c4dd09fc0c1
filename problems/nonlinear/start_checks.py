"""Checks of F and of the start."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import expect
from continuation.arrays import Array, Matrix
from problems.options import finite_vector, quiet

Function = Callable[[Array], Array]
"""R^n -> R^n; complex numbers and jets pass through plain numpy."""

Jacobian = Callable[[Array], Matrix]
"""F', (n, n): any matrix that `continuation.linear` factors."""


def start_vector(a: Any) -> Array:
    """Copy a finite vector, or raise ValueError."""
    return finite_vector("a", a)


def value_at(F: Function, a: Array) -> Array:
    """F(a), finite, of a's shape; else `TypeError` or `ValueError`."""
    expect(callable(F), "F", "a function", F, TypeError)
    value: Any = quiet(F)(a.copy())
    if not isinstance(value, np.ndarray):
        raise TypeError(f"F(a): expected an array of shape {a.shape}, found {type(value).__name__}")
    expect(value.shape == a.shape, "F(a)", f"shape {a.shape}, that of a", value.shape)
    return finite_vector("F(a)", value)


def check_jacobian_shape(jacobian: Jacobian, a: Array) -> None:
    """Raise TypeError unless `jacobian` returns a matrix, ValueError if not (n, n)."""
    expect(callable(jacobian), "jacobian", "a function", jacobian, TypeError)
    shape = getattr(quiet(jacobian)(a.copy()), "shape", None)
    expect(shape is not None, "jacobian(a)", "a matrix with a shape", shape, TypeError)
    expect(shape == (a.size, a.size), "jacobian(a)", f"shape {(a.size, a.size)}", shape)


@frozen(eq=False, slots=False)
class FromPoint:
    """A homotopy from x = a at lam = 1 to F(x) = 0 at lam = 0; with F' it has a `jacobian`."""

    F: Function
    a: Array = field(converter=start_vector)
    slope: Jacobian | None = None
    value: Array = field(init=False, repr=False)
    """F(a), shape (n,)."""
    problem_class: ClassVar[str] = "nonlinear equations F(x) = 0"
    target: ClassVar[float | None] = 0.0

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "value", value_at(self.F, self.a))
        if self.slope is not None:
            check_jacobian_shape(self.slope, self.a)
            object.__setattr__(self, "jacobian", self._jacobian)

    def start(self) -> tuple[Array, float]:
        """(a, 1)."""
        return self.a.copy(), 1.0

    def _jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        raise NotImplementedError
