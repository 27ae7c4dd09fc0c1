"""Bratu's problem on an interval."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.events.box import Box
from continuation.linear import Banded
from problems.bibliography import BRATU
from problems.options import finite_or_none, positive_integer, quiet


@frozen
class Bratu1D:
    """u'' + lam e^u = 0 on (0, 1), u(0) = u(1) = 0, by second-order differences, from u = 0 at lam = 0.

    ``H_i = u_{i-1} - 2 u_i + u_{i+1} + h^2 lam e^{u_i}``, h = 1/(n + 1). The path turns at lam* = 3.5138... and returns
    towards lam = 0.

    Parameters
    ----------
    n : int
        Interior points.
    target : float or None
        lam at the path's end; None: max u = 8.

    References
    ----------
    Bratu, Bull. Soc. Math. France 42, 1914.
    """

    n: int = field(default=100, validator=positive_integer)
    target: float | None = field(default=None, validator=finite_or_none)
    box: ClassVar[Box] = {"y": (None, 8.0)}
    parameter_name: ClassVar[str] = "lambda"
    problem_class: ClassVar[str] = "nonlinear boundary-value problems, discretised"
    references: ClassVar[tuple[str, ...]] = (BRATU,)

    def start(self) -> tuple[Array, float]:
        """Zero at lam = 0."""
        return np.zeros(self.n), 0.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        u = np.concatenate((np.zeros(1), y, np.zeros(1)))
        return u[:-2] - 2.0 * y + u[2:] + (1.0 / (self.n + 1.0) ** 2) * lam * np.exp(y)

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Banded, Array]:
        """(H_y, H_lam): tridiagonal; shape (n,)."""
        slope = (1.0 / (self.n + 1.0) ** 2) * np.exp(y)
        bands = np.ones((3, self.n))
        bands[1] = lam * slope - 2.0
        return Banded(bands, 1, 1), slope

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """Maximum of u."""
        return {"max_u": float(np.max(y))}
