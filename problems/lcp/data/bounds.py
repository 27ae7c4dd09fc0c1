"""Checks of bounds."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Array
from problems.options import expect_nowhere, real_array


def bound_vector(name: str, value: Any, size: int, default: float) -> Array:
    """Bounds as a vector of shape (size,); the only infinity allowed is `default`.

    `value` may be one number, or None for `default`. `ValueError` if it is sparse, not real, of another length, NaN, or
    the wrong infinity.
    """
    value = default if value is None else value
    if sp.issparse(value):
        raise ValueError(f"{name}: expected a dense vector, found a sparse one; give toarray(), in which 0 is a bound")
    bounds = real_array(name, value)
    if bounds.ndim == 0:
        bounds = np.full(size, float(bounds))
    if bounds.shape != (size,):
        raise ValueError(f"{name}: expected {size} numbers, one an unknown, found shape {bounds.shape}")
    wrong = np.isnan(bounds) | (bounds == -default)
    expect_nowhere(wrong, name, f"numbers or {default}", lambda i: f"{bounds[i]} at index {i}")
    return bounds


def without_equal_bounds(low: Array, high: Array) -> None:
    """Raise ValueError, naming the first index, where low = high."""
    expect_nowhere(low == high, "lower", "less than upper", lambda i: f"both {low[i]} at index {i}; leave x[{i}] out")


def ordered_bounds(low: Array, high: Array, name: str = "lower", other: str = "upper") -> None:
    """Raise ValueError, naming the first index, where low > high."""
    expect_nowhere(low > high, name, f"at most {other}", lambda i: f"{name}[{i}] = {low[i]} > {other}[{i}] = {high[i]}")
