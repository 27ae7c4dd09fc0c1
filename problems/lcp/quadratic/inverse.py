"""Approximate inverses of stacks of matrices of which a part is diagonal, and how far off they are."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Index
from continuation.certificate.inverse import inverses, times

INVERSE_ERROR = 1e-4
"""An eliminated inverse farther off than this, in the norm of the radii, is replaced: a test has room for as much."""


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
    upper, lower = matrices.take(rows, axis=1), matrices.take(i, axis=1)
    right, below = upper.take(j, axis=2) * pivot[:, :, None], lower.take(columns, axis=2)
    inner = inverses(lower.take(j, axis=2) - np.matmul(below, right))
    below *= pivot[:, None, :]
    across = np.matmul(inner, below)
    corner = np.matmul(right, across)
    corner[:, np.arange(len(rows)), np.arange(len(rows))] += pivot
    # In the order of the pivots first; then in that of the matrix.
    Y = np.empty_like(matrices)
    k = len(rows)
    Y[:, :k, :k], Y[:, k:, k:] = corner, inner
    np.negative(np.matmul(right, inner), out=Y[:, :k, k:])
    np.negative(across, out=Y[:, k:, :k])
    from_rows, from_columns = np.empty(m, np.intp), np.empty(m, np.intp)
    from_rows[np.concatenate([rows, i])] = from_columns[np.concatenate([columns, j])] = np.arange(m)
    return Y.take(from_columns, axis=1).take(from_rows, axis=2)


def inverted(
    matrices: Array,
    rows: Index,
    columns: Index,
    radius: Array,
    product: Callable[[Array, Any], Array] | None = None,
) -> tuple[Array, Array, Array]:
    """Approximate inverses Y of a stack G, and |I - Y G|: by elimination, and where that is too far off in full.

    Parameters
    ----------
    matrices : ndarray, shape (slabs, m, m)
    rows, columns : ndarray of int
        Where all of them are diagonal.
    radius : ndarray, shape (slabs, m)
        The norm.
    product : callable, optional
        Of some Y, and which they are: Y G and other products that are wanted with it, shape (any, slabs, m, m).

    Returns
    -------
    Y, off : ndarray
    others : ndarray
        The other products.
    """
    if product is None:
        product = partial(_plain, matrices)
    eye = np.eye(matrices.shape[1])
    Y = eliminated(matrices, rows, columns) if len(rows) else inverses(matrices)
    found = product(Y, slice(None))
    off = np.abs(eye - found[0])
    bad = np.flatnonzero(~(times(off, radius) < INVERSE_ERROR * radius).all(axis=1))
    if len(rows) and len(bad):
        Y[bad] = inverses(matrices[bad])
        found[:, bad] = product(Y[bad], bad)
        off[bad] = np.abs(eye - found[0, bad])
    return Y, off, found[1:]


def _plain(matrices: Array, Y: Array, place: Any) -> Array:
    found: Array = np.matmul(Y, matrices[place])[None]
    return found
