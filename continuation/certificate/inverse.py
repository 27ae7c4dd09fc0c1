"""Products and inverses of stacks of matrices."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from continuation.arrays import Array


def times(matrix: Array, x: Array) -> Array:
    """Matrix times vector, slab by slab."""
    product: Array = np.matmul(matrix, x[..., None])[..., 0]
    return product


def inverses(matrices: Array) -> Array:
    """Approximate inverses; nan for singular matrices."""
    try:
        return np.asarray(np.linalg.inv(matrices), dtype=float)
    except np.linalg.LinAlgError:
        out = np.full_like(matrices, np.nan)
        for k, matrix in enumerate(matrices):
            with suppress(np.linalg.LinAlgError):
                out[k] = np.linalg.inv(matrix)
        return out
