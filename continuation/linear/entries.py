"""Real entries, and bordered matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Array, Matrix


def require_real(name: str, dtype: np.dtype[Any]) -> None:
    """Raise TypeError unless `dtype` holds real numbers."""
    if dtype.kind not in "fiub":
        raise TypeError(f"{name} has entries of type {dtype}; expected real numbers")


def real(name: str, entries: Any) -> Array:
    """Entries as float64, or TypeError with `name`."""
    array = np.asarray(entries)
    require_real(name, array.dtype)
    return array if array.dtype == np.float64 else array.astype(float)


def extended(matrix: Matrix, columns: Array, rows: Array) -> Matrix:
    """[[matrix, columns], [rows]] of shapes (n, m), (n, k), (l, m + k), dense or csc; faster than `block_array`."""
    if not sp.issparse(matrix):
        return np.vstack([np.hstack([matrix, columns]), rows])
    part, (n, m) = sp.csc_array(matrix), matrix.shape
    (i, j), (p, q) = np.nonzero(columns), np.nonzero(rows)
    column = np.repeat(np.arange(m), np.diff(part.indptr))
    place = np.concatenate([part.indices, i, n + p]), np.concatenate([column, m + j, q])
    data = np.concatenate([part.data, columns[i, j], rows[p, q]])
    return sp.csc_array((data, place), shape=(n + len(rows), m + columns.shape[1]))
