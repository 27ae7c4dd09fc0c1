"""Checks of bounds at the door: each a sentence that names the index."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Array
from problems.options import real_array


def bound_vector(name: str, value: Any, size: int, default: float) -> Array:
    """Bounds as a vector of floats, of which one of the two infinities, `default`, is allowed.

    `name`: The argument, for the message. `value`, of shape (size,): One number is that of all indices; None is
    `default` for all. `default`: -inf for lower bounds, inf for upper ones. Raises `ValueError` if it is sparse (is
    what is not stored zero, or no bound?), not real, of another length, NaN, or the wrong infinity; the message names
    the index.
    """
    if value is None:
        return np.full(size, default)
    if sp.issparse(value):
        raise ValueError(f"{name}: expected a dense vector, found a sparse one; give toarray(), in which 0 is a bound")
    bounds = real_array(name, value)
    if bounds.ndim == 0:
        bounds = np.full(size, float(bounds))
    if bounds.shape != (size,):
        raise ValueError(f"{name}: expected {size} numbers, one an unknown, found shape {bounds.shape}")
    wrong = np.isnan(bounds) | (bounds == -default)
    if wrong.any():
        i = int(np.argmax(wrong))
        raise ValueError(f"{name}: expected numbers or {default}, found {bounds[i]} at index {i}")
    return bounds


def ordered_bounds(lower: Array, upper: Array) -> None:
    """Raise ValueError, naming the first index, where a lower bound is above the upper one."""
    if (lower > upper).any():
        i = int(np.argmax(lower > upper))
        raise ValueError(f"lower: expected at most upper, found lower[{i}] = {lower[i]} > upper[{i}] = {upper[i]}")
