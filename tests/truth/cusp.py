"""The cusp, exactly."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array


def curve(x: Array, splitting: float = 1.0) -> Array:
    """Points (x, mu) of the path at `x`, shape (..., 2)."""
    return np.stack((x, x * (x * x - splitting)), axis=-1)


def turning_points(splitting: float = 1.0) -> Array:
    """Rows (x, mu) at x = -sqrt(lambda/3), sqrt(lambda/3), shape (2, 2); shape (0, 2) where lambda <= 0."""
    if splitting <= 0.0:
        return np.empty((0, 2))
    x = np.sqrt(splitting / 3.0)
    return np.array([[-x, 2.0 / 3.0 * splitting * x], [x, -2.0 / 3.0 * splitting * x]])
