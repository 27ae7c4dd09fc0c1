"""Approximate inverses of stacks of matrices, and how far off they are."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Index

ROUGH = 1e-4
"""An eliminated inverse farther off than this, in the norm of the radii, is replaced: a test has room for as much."""


def times(matrix: Array, x: Array) -> Array:
    """Matrices times vectors, slab by slab."""
    product: Array = np.matmul(matrix, x[..., None])[..., 0]
    return product


def inverses(matrices: Array) -> Array:
    """Approximate inverses of a stack; nan for a singular one."""
    try:
        return np.asarray(np.linalg.inv(matrices), dtype=float)
    except np.linalg.LinAlgError:
        out = np.full_like(matrices, np.nan)
        for k, matrix in enumerate(matrices):
            if np.isfinite(matrix).all() and np.linalg.matrix_rank(matrix) == len(matrix):
                out[k] = np.linalg.inv(matrix)
        return out


def eliminated(matrices: Array, rows: Index, columns: Index) -> Array:
    """Approximate inverses of a stack by way of those of smaller matrices: of that what is diagonal is eliminated.

    Small pivots cost accuracy; whoever uses the inverses has to look at I - Y G.

    Parameters
    ----------
    matrices : ndarray, shape (slabs, m, m)
    rows, columns : ndarray of int
        Where all of them are diagonal.
    """
    m = matrices.shape[1]
    i, j = (np.setdiff1d(np.arange(m), known) for known in (rows, columns))
    pivot = 1.0 / matrices[:, rows, columns]
    right, below = matrices[:, rows[:, None], j] * pivot[:, :, None], matrices[:, i[:, None], columns]
    inner = inverses(matrices[:, i[:, None], j] - np.matmul(below, right))
    across = -np.matmul(inner, below * pivot[:, None, :])
    corner = -np.matmul(right, across)
    corner[:, np.arange(len(rows)), np.arange(len(rows))] += pivot
    Y = np.empty_like(matrices)
    Y[:, j[:, None], i], Y[:, j[:, None], rows] = inner, across
    Y[:, columns[:, None], i], Y[:, columns[:, None], rows] = -np.matmul(right, inner), corner
    return Y


def inverted(matrices: Array, rows: Index, columns: Index, radius: Array) -> tuple[Array, Array]:
    """Approximate inverses Y of a stack G, and |I - Y G|: by elimination, and where that is too far off in full.

    Parameters
    ----------
    matrices : ndarray, shape (slabs, m, m)
    rows, columns : ndarray of int
        Where all of them are diagonal.
    radius : ndarray, shape (slabs, m)
        The norm.
    """
    eye, bad = np.eye(matrices.shape[1]), np.arange(len(matrices))
    Y, R = np.empty_like(matrices), np.empty_like(matrices)
    if len(rows):
        Y = eliminated(matrices, rows, columns)
        R = np.abs(eye - np.matmul(Y, matrices))
        bad = np.flatnonzero(~(times(R, radius) < ROUGH * radius).all(axis=1))
    if len(bad):
        Y[bad] = inverses(matrices[bad])
        R[bad] = np.abs(eye - np.matmul(Y[bad], matrices[bad]))
    return Y, R
