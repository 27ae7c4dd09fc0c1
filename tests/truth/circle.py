"""The circle, exactly."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array


def curve(angle: Array) -> Array:
    """Points (u, lam) at `angle` from the start (1, 0), shape (..., 2)."""
    return np.stack((np.cos(angle), np.sin(angle)), axis=-1)


def turning_points() -> Array:
    """Rows (u, lam) in the order of a turn that begins with lam increasing, shape (2, 2)."""
    return np.array([[0.0, 1.0], [0.0, -1.0]])
