"""The pitchfork, exactly."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array

BRANCH_POINT = (0.0, 0.0)
"""(x, lam) where the four arms of the perfect pitchfork meet."""


def bifurcated_branch(x: Array) -> Array:
    """Points (x, lam) of the branch x^2 = lam of the perfect pitchfork, shape (..., 2)."""
    return np.stack((x, x * x), axis=-1)


def curve(x: Array, imperfection: float) -> Array:
    """Points (x, lam) of the imperfect pitchfork at x != 0, shape (..., 2); both signs of x are branches."""
    return np.stack((x, x * x - imperfection / x), axis=-1)


def turning_points(imperfection: float) -> Array:
    """Rows (x, lam) of the branch that the path from lam = -1 does not meet, shape (1, 2).

    The start's own branch has none.
    """
    x = -np.cbrt(0.5 * imperfection)
    return np.array([[x, 3.0 * x * x]])
