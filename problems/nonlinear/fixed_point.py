"""The fixed-point homotopy."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.bibliography import CHOW_MALLET_PARET_YORKE
from problems.lcp.data.matrix_structure import scaled
from problems.nonlinear import start_checks
from problems.nonlinear.start_checks import Derivative, Function, Jacobian
from problems.options import quiet


@frozen(eq=False)
class FixedPointHomotopy:
    """H(x, lam) = (1 - lam) F(x) + lam (x - a), from x = a at lam = 1 to F(x) = 0 at lam = 0.

    Parameters
    ----------
    F : callable
        ``F(x) -> (n,)``.
    a : array_like, shape (n,)
        Start; for almost every a the path is regular.
    slope : callable, optional
        ``slope(x) -> (n, n)``, F': dense, sparse or `Banded`. With it the homotopy has a `jacobian`.

    References
    ----------
    Chow, Mallet-Paret and Yorke, Math. Comp. 32, 1978.
    """

    F: Function
    a: Array = field(converter=start_checks.start_vector)
    slope: Jacobian | None = None
    value: Array = field(init=False, repr=False, default=start_checks.VALUE)
    """F(a), shape (n,)."""
    problem_class: ClassVar[str] = "nonlinear equations F(x) = 0"
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (CHOW_MALLET_PARET_YORKE,)
    start = start_checks.start

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        return (1.0 - lam) * self.F(y) + lam * (y - self.a)

    @property
    def jacobian(self) -> Derivative | None:
        """Maps (y, lam) to (H_y, H_lam), where H_y has the structure of F'; None without F'."""
        slope, one = self.slope, np.ones(self.a.size)
        return (
            None
            if slope is None
            else quiet(lambda y, lam: (scaled(slope(y), (1.0 - lam) * one, lam * one), y - self.a - self.F(y)))
        )


def fixed_point(F: Function, a: Any, jacobian: Jacobian | None = None) -> FixedPointHomotopy:
    """The fixed-point homotopy of F from `a`.

    Parameters
    ----------
    F : callable
    a : array_like, shape (n,)
    jacobian : callable, optional
        ``jacobian(x) -> (n, n)``: dense, sparse or `Banded`.
    """
    return FixedPointHomotopy(F, a, jacobian)
