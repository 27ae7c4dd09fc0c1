"""The circle, exactly."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array


def curve(angle: Array) -> Array:
    """Points (u, lam) at `angle` from the start (1, 0), shape (..., 2)."""
    return np.stack((np.cos(angle), np.sin(angle)), axis=-1)
