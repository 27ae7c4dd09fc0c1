"""Products with the derivative of a quadratic homotopy, block by block: most of its entries are zero."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.certificate.cells import Index

COLUMN_RUNS = 4
"""Columns in more runs than that are gathered; each run is a product of its own, on a part of the array."""

SPARSE_ROW = 3
"""A row with so many entries is not put into a dense block with longer ones."""


def _runs(index: Index) -> list[Any]:
    """Indices as slices, where they are few runs."""
    parts = np.split(index, np.flatnonzero(np.diff(index) != 1) + 1)
    return [slice(int(part[0]), int(part[-1]) + 1) for part in parts] if len(parts) <= COLUMN_RUNS else [index]


@frozen(eq=False)
class Blocks:
    """Rows of a matrix: dense blocks, and entries that are alone in their columns.

    Attributes
    ----------
    dense, single : list
        Rows, columns and entries; of single ones one for each column.
    """

    dense: list[tuple[Any, Any, Array]]
    single: list[tuple[Any, Any, Array]]

    @classmethod
    def of(cls, matrix: Array, rows: Index) -> list[Blocks]:
        """Those rows of a matrix: the ones with few entries, and the others."""
        few = (matrix[rows] != 0.0).sum(axis=1) <= SPARSE_ROW
        return [cls._of(matrix, some) for some in (rows[few], rows[~few]) if len(some)]

    @classmethod
    def _of(cls, matrix: Array, rows: Index) -> Blocks:
        there = matrix[rows] != 0.0
        count = there.sum(axis=0)
        many, alone = np.flatnonzero(count > 1), np.flatnonzero(count == 1)
        owners = rows[there[:, alone].argmax(axis=0)] if len(alone) else alone
        full = rows[there[:, many].any(axis=1)]
        # A slice of rows that has a few more of them, which are zero there, is read without a copy.
        if len(full) and int(full[-1] - full[0]) < 2 * len(full) and np.isin(np.arange(full[0], full[-1]), rows).all():
            full = np.arange(full[0], full[-1] + 1)
        run = _runs(full) if len(full) else []
        place = run[0] if len(run) == 1 else full
        dense = [
            (place, columns, np.ascontiguousarray(matrix[full][:, columns]))
            for columns in (_runs(many) if len(many) else [])
        ]
        kinds: list[tuple[Any, Any, Array]] = []
        if len(alone):
            for part in np.split(
                np.arange(len(alone)), np.flatnonzero((np.diff(alone) != 1) | (np.diff(owners) != 1)) + 1
            ):
                i, j = owners[part], alone[part]
                kinds.append((_runs(i)[0], _runs(j)[0], matrix[i, j]))
            if len(kinds) > COLUMN_RUNS:
                kinds = [(owners, alone, matrix[owners, alone])]
        return cls(dense, kinds)

    def add(self, out: Array, left: Array, scale: Array, factor: Array | None = None) -> None:
        """Add left diag(factor) times the rows times diag(scale), slab by slab.

        Parameters
        ----------
        out : ndarray, shape (slabs, m, columns)
        left : ndarray, shape (slabs, m, rows)
        scale : ndarray, shape (slabs, columns)
        factor : ndarray, shape (slabs, rows), optional
        """
        for rows, columns, block in self.dense:
            entries = block * scale[:, None, columns]
            if factor is not None:
                entries *= factor[:, rows, None]
            out[:, :, columns] += np.matmul(left[:, :, rows], entries)
        for rows, columns, values in self.single:
            entries = values * scale[:, columns]
            if factor is not None:
                entries *= factor[:, rows]
            out[:, :, columns] += left[:, :, rows] * entries[:, None]
