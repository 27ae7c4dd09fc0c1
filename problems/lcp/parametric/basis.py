"""The square part of the equations on one piece, factored at each corner, its solutions refined."""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from attrs import frozen
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from continuation.arrays import Array

EXTENDED = 4096
"""Entries up to which what is left is computed in extended precision, which costs 20 us for so many: then refinement
makes kinks exact to round-off whatever the condition, and 10,000 problems of integers (n <= 6) to 1e-14."""


class SingularBasisError(ValueError):
    """The columns of a basis are dependent."""


@frozen(eq=False)
class Basis:
    """Rows and columns of [A, d], equally many, and the factors of their block.

    `rows`, `columns`, of shape (k,): Column n is that of t. `block`, of shape (n, k): The columns, all rows of them.
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    block: Array
    _factors: tuple[Any, Any]

    @classmethod
    def of(cls, rows: NDArray[np.intp], columns: NDArray[np.intp], block: Array) -> Self:
        """Factor the block; raises `SingularBasisError` if it has no inverse."""
        if not rows.size:
            return cls(rows, columns, block, (None, None))
        lu, pivots, singular = dgetrf(block[rows])
        if singular or not np.isfinite(lu).all():
            raise SingularBasisError("the columns are dependent")
        return cls(rows, columns, block, (lu, pivots))

    def solve(self, right: Array) -> tuple[Array, Array]:
        """Basic variables z with ``block z + right = 0`` on the rows, and what is left of that on all of them.

        Refined twice. `right` of shape (n, m). Returns z, of shape (k, m), and left, of shape (n, m).
        """
        if not self.rows.size:
            return np.zeros((0, right.shape[1])), right
        block, fine = self.block, self.block.size <= EXTENDED
        z = -self._inverse(right[self.rows])
        for _ in range(2):
            left = (block.astype(np.longdouble) @ z + right).astype(float) if fine else block @ z + right
            correction = self._inverse(left[self.rows])
            z -= correction
            left -= block @ correction
        return z, left

    def row_of_inverse(self, column: int) -> Array:
        """How one of the basic variables depends on the rows, shape (k,)."""
        return self._inverse((self.columns == column).astype(float), transposed=1)

    def _inverse(self, right: Array, transposed: int = 0) -> Array:
        solved: Array = dgetrs(*self._factors, right, trans=transposed)[0]
        return solved
