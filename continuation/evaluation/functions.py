"""Homotopies from plain functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import complain, real_vector
from continuation.arrays import Array, Matrix


def _start_vector(y: object) -> Array:
    return np.array(y, dtype=float, ndmin=1)


@frozen(eq=False)
class FunctionHomotopy:
    """A homotopy by `from_functions`, without derivative."""

    function: Callable[[Any, Any], Any]
    y0: Array = field(converter=_start_vector)
    lam0: float = field(converter=float)
    target: float | None = 0.0
    sparsity: Matrix | None = None

    def start(self) -> tuple[Array, float]:
        """The given start."""
        return self.y0.copy(), self.lam0

    def residual(self, y: Array, lam: float) -> Array:
        """The given residual."""
        value: Array = self.function(y, lam)
        return value


@frozen(eq=False)
class DifferentiableHomotopy:
    """A homotopy by `from_functions`, with derivative."""

    plain: FunctionHomotopy
    derivative: Callable[[Any, Any], tuple[Matrix, Array]]

    @property
    def target(self) -> float | None:
        """Final parameter value."""
        return self.plain.target

    def start(self) -> tuple[Array, float]:
        """The given start."""
        return self.plain.start()

    def residual(self, y: Array, lam: float) -> Array:
        """The given residual."""
        return self.plain.residual(y, lam)

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """The given derivative."""
        return self.derivative(y, lam)


def from_functions(
    residual: Callable[[Any, Any], Any],
    jacobian: Callable[[Any, Any], tuple[Any, Any]] | None = None,
    *,
    start: tuple[Any, float],
    target: float | None = 0.0,
    sparsity: Any = None,
) -> FunctionHomotopy | DifferentiableHomotopy:
    """Make a homotopy from functions.

    Parameters
    ----------
    residual : callable
        ``residual(y, lam) -> (N,)``.
    jacobian : callable, optional
        ``jacobian(y, lam) -> (H_y, H_lam)``; default: from `residual`.
    start : tuple
        ``(y0, lam0)``, near the path.
    target : float or None
        Final parameter value, if any.
    sparsity : array or sparse array, shape (N, N), optional
        Nonzero where H_y may be, without `jacobian`. Default: searched.

    Raises
    ------
    TypeError, ValueError
        If an argument is no function, or the start no pair.
    """
    for name, function in (("residual", residual), ("jacobian", jacobian)):
        if not callable(function) and (name == "residual" or function is not None):
            raise complain(TypeError, name, "a function of (y, lam)", function)
    if not isinstance(start, (tuple, list)) or len(start) != 2:
        raise complain(ValueError, "start", "a pair (y0, lam0)", start)
    y0, lam0 = (real_vector("start", value) for value in start)
    if lam0.size != 1:
        raise complain(ValueError, "start", "a pair (y0, lam0) with one number lam0", start)
    plain = FunctionHomotopy(residual, y0, lam0, target, sparsity)
    return plain if jacobian is None else DifferentiableHomotopy(plain, jacobian)
