"""Statistics of a sparse matrix, to choose a factorisation."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.linear.refine import BACKWARD_ERROR


@frozen(eq=False, slots=False)
class Look:
    """Statistics of a canonical matrix, (N, N), on demand."""

    matrix: Matrix

    @property
    def n(self) -> int:
        """The order."""
        return int(self.matrix.shape[0])

    @cached_property
    def _rows(self) -> Matrix:
        return self.matrix.tocsr()

    @cached_property
    def diagonal(self) -> Array:
        """The diagonal, shape (N,)."""
        return np.asarray(self.matrix.diagonal())

    @cached_property
    def symmetric_pattern(self) -> bool:
        """Whether the pattern is symmetric with full diagonal: minimum degree then halves COLAMD's fill."""
        if not self.diagonal.all():
            return False
        rows, columns = self._rows, self.matrix
        columns.sort_indices()
        return np.array_equal(rows.indptr, columns.indptr) and np.array_equal(rows.indices, columns.indices)

    @cached_property
    def definite_perhaps(self) -> bool:
        """Whether the matrix is symmetric, up to rounding, with positive diagonal."""
        if not (self.diagonal > 0.0).all() or not self.symmetric_pattern:
            return False
        here, across = self.matrix.data, self._rows.data
        if np.array_equal(here, across):
            return True
        root = np.sqrt(self.diagonal)
        size = root[self.matrix.indices] * np.repeat(root, np.diff(self.matrix.indptr))
        return bool((np.abs(here - across) <= BACKWARD_ERROR * size).all())
