"""Perfect and imperfect pitchfork."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.bibliography import GOLUBITSKY_SCHAEFFER
from problems.options import finite, finite_or_none, quiet


@frozen
class Pitchfork:
    """H(x, lam) = lam x - x^3 + eps, one unknown, from lam = -1 to lam = 1.

    Parameters
    ----------
    imperfection : float
        eps. For 0 the path x = 0 meets x^2 = lam in a branch point. Otherwise the path keeps the sign of eps.
    target : float or None
        lam at the end.

    References
    ----------
    Golubitsky and Schaeffer, Singularities and Groups in Bifurcation Theory I, 1985, chapter I.
    """

    imperfection: float = field(default=0.0, validator=finite)
    target: float | None = field(default=1.0, validator=finite_or_none)
    problem_class: ClassVar[str] = "singularities, to test with"
    references: ClassVar[tuple[str, ...]] = (GOLUBITSKY_SCHAEFFER,)

    def start(self) -> tuple[Array, float]:
        """The real root of x^3 + x = eps."""
        third = np.arcsinh(1.5 * np.sqrt(3.0) * self.imperfection) / 3.0
        return np.array([2.0 / np.sqrt(3.0) * np.sinh(third)]), -1.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (1,)."""
        return y * (lam - y * y) + self.imperfection

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """(H_y, H_lam), shapes (1, 1) and (1,)."""
        return (lam - 3.0 * y * y)[:, None], 1.0 * y
