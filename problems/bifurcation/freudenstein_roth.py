"""The Freudenstein-Roth function, embedded."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.bibliography import FREUDENSTEIN_ROTH, RHEINBOLDT_BURKARDT
from problems.options import finite_or_none, quiet

_COEFFICIENTS = np.array([[-1.0, 1.0], [5.0, 1.0], [-2.0, -14.0], [-13.0, -29.0], [34.0, 10.0]])
"""Coefficients of x2^3, x2^2, x2, 1 and lam - 1 in both equations."""


@frozen
class FreudensteinRoth:
    """Two equations whose path to the root (5, 4) turns twice in lam and passes a sharp bend.

    ``H1 = x1 - x2^3 + 5 x2^2 - 2 x2 - 13 + 34 (lam - 1)``, ``H2 = x1 + x2^3 + x2^2 - 14 x2 - 29 + 10 (lam - 1)``, from
    (15, -2) at lam = 0 to (5, 4) at lam = 1.

    Parameters
    ----------
    target : float or None
        lam at the end.

    Notes
    -----
    Near x2 = -1.74 a long step turns the tangent by over 90 degrees, which may look like a fold.

    References
    ----------
    Freudenstein and Roth, J. ACM 10, 1963; Rheinboldt and Burkardt, ACM TOMS 9(2), 1983.
    """

    target: float | None = field(default=1.0, validator=finite_or_none)
    problem_class: ClassVar[str] = "nonlinear equations, to test with"
    references: ClassVar[tuple[str, ...]] = (FREUDENSTEIN_ROTH, RHEINBOLDT_BURKARDT)

    def start(self) -> tuple[Array, float]:
        """(15, -2) at lam = 0."""
        return np.array([15.0, -2.0]), 0.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """(H1, H2), shape (2,)."""
        x1, x2 = y[0], y[1]
        cubic, square, linear, constant, embedding = _COEFFICIENTS
        equations: Array = x1 + x2 * (linear + x2 * (square + x2 * cubic)) + constant + (lam - 1.0) * embedding
        return equations

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """(H_y, H_lam), shapes (2, 2) and (2,)."""
        cubic, square, linear, _, embedding = _COEFFICIENTS
        slope = linear + y[1] * (2.0 * square + 3.0 * y[1] * cubic)
        return np.stack((np.ones(2), slope), axis=1), embedding.copy()
