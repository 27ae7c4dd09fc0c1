"""The pitchfork, exactly."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array


def bifurcated_branch(x: Array) -> Array:
    """Points (x, lam) of the branch x^2 = lam of the perfect pitchfork, shape (..., 2)."""
    return np.stack((x, x * x), axis=-1)


def curve(x: Array, imperfection: float) -> Array:
    """Points (x, lam) of the imperfect pitchfork at x != 0, shape (..., 2); both signs of x are branches."""
    return np.stack((x, x * x - imperfection / x), axis=-1)
