"""What may stand in a matrix: real numbers, and finite ones."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array


def require_real(name: str, dtype: np.dtype[Any]) -> None:
    """Raise TypeError unless `dtype` holds real numbers."""
    if dtype.kind not in "fiub":
        raise TypeError(f"{name} has entries of type {dtype}; expected real numbers")


def real(name: str, entries: Any) -> Array:
    """The entries as float64, copied only where they are of another type.

    Raises
    ------
    TypeError
        If they are not real numbers; `name` is what the message calls them.
    """
    array = np.asarray(entries)
    require_real(name, array.dtype)
    return array if array.dtype == np.float64 else array.astype(float)
