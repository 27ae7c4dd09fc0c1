"""The pitchfork, perfect and imperfect."""

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
        The eps. With 0 the path is the trivial branch x = 0, which meets x^2 = lam in a branch point at lam = 0. Else
        the path has the sign of eps and avoids the branch point; the other two arms join in a turning point.
    target : float or None
        Where the path ends.

    References
    ----------
    Golubitsky and Schaeffer, Singularities and Groups in Bifurcation Theory I, 1985, chapter I.
    """

    imperfection: float = field(default=0.0, validator=finite)
    target: float | None = field(default=1.0, validator=finite_or_none)
    problem_class: ClassVar[str] = "singularities, to test with"
    references: ClassVar[tuple[str, ...]] = (GOLUBITSKY_SCHAEFFER,)

    def start(self) -> tuple[Array, float]:
        """The only real root at lam = -1, x^3 + x = eps, by the hyperbolic form of Cardano's formula."""
        third = np.arcsinh(1.5 * np.sqrt(3.0) * self.imperfection) / 3.0
        return np.array([2.0 / np.sqrt(3.0) * np.sinh(third)]), -1.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H = lam x - x^3 + eps, shape (1,)."""
        return y * (lam - y * y) + self.imperfection

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """(H_y, H_lam), shapes (1, 1) and (1,)."""
        return (lam - 3.0 * y * y)[:, None], 1.0 * y
