"""The cusp."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import field, fields, frozen

from continuation.arrays import Array
from problems.bibliography import GOLUBITSKY_SCHAEFFER
from problems.options import finite, finite_or_none, quiet


@frozen
class Cusp:
    """F(x, mu) = mu + lambda x - x^3, continued in mu.

    Parameters
    ----------
    splitting : float
        Fixed lambda: two folds if positive, none if negative.
    target : float or None
        lam at the end; default: the start's mirror image.

    References
    ----------
    Golubitsky and Schaeffer, Singularities and Groups in Bifurcation Theory I, 1985, chapter III.
    """

    splitting: float = field(default=1.0, validator=finite)
    target: float | None = field(validator=finite_or_none)
    problem_class: ClassVar[str] = "singularities, to test with"
    references: ClassVar[tuple[str, ...]] = (GOLUBITSKY_SCHAEFFER,)

    @target.default
    def _mirrored_start(self) -> float:
        finite(self, fields(Cusp).splitting, self.splitting)
        return -self.start()[1]

    def start(self) -> tuple[Array, float]:
        """The point x = -1 - sqrt(abs(lambda))."""
        x = -1.0 - float(np.sqrt(abs(self.splitting)))
        return np.array([x]), x * (x * x - self.splitting)

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """F, shape (1,)."""
        return lam + y * (self.splitting - y * y)

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """(F_x, F_mu), shapes (1, 1) and (1,)."""
        return (self.splitting - 3.0 * y * y)[:, None], np.ones(1)
