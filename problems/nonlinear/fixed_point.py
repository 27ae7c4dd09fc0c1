"""The fixed-point homotopy."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix
from problems.bibliography import CHOW_MALLET_PARET_YORKE
from problems.lcp.data.matrix_structure import scaled
from problems.nonlinear.start_checks import FromPoint, Function, Jacobian
from problems.options import quiet


@frozen(eq=False, slots=False)
class FixedPointHomotopy(FromPoint):
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

    references: ClassVar[tuple[str, ...]] = (CHOW_MALLET_PARET_YORKE,)

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        return (1.0 - lam) * self.F(y) + lam * (y - self.a)

    @quiet
    def _jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam); H_y has the structure of F'."""
        assert self.slope is not None
        aside = np.full(y.size, lam)
        return scaled(self.slope(y), 1.0 - aside, aside), y - self.a - self.F(y)


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
