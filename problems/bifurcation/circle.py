"""The unit circle."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.citation.bibliography import ALLGOWER_GEORG
from problems.options import quiet


@frozen
class Circle:
    """H(u, lam) = u^2 + lam^2 - 1, one unknown, from (1, 0).

    The path closes after arclength 2 pi; it turns at (0, 1) and (0, -1).

    References
    ----------
    Allgower and Georg, Introduction to Numerical Continuation Methods, 2003.
    """

    target: ClassVar[float | None] = None
    problem_class: ClassVar[str] = "plane curves, to test with"
    references: ClassVar[tuple[str, ...]] = (ALLGOWER_GEORG,)

    def start(self) -> tuple[Array, float]:
        """The point (1, 0)."""
        return np.ones(1), 0.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (1,)."""
        return y * y + (lam * lam - 1.0)

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """(H_y, H_lam), shapes (1, 1) and (1,)."""
        return 2.0 * y[:, None], np.array([2.0 * lam])
