"""A piece's square equations, factored, with refined solutions."""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from attrs import frozen
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from continuation.arrays import Array

EXTENDED = 4096
"""Largest block with residuals in extended precision: kinks of 10,000 integer problems (n <= 6) are exact to 1e-14."""


class SingularBasisError(ValueError):
    """The columns of a basis are dependent."""


@frozen(eq=False)
class Basis:
    """A square block of [A, d] and its factors.

    Column n is that of t; `block` holds all rows of the columns, shape (n, k).
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    block: Array
    _factors: tuple[Any, Any]

    @classmethod
    def of(cls, rows: NDArray[np.intp], columns: NDArray[np.intp], block: Array, least: float = 0.0) -> Self:
        """Factor the block; raises `SingularBasisError` unless all pivots are above `least`."""
        if not rows.size:
            return cls(rows, columns, block, (None, None))
        lu, pivots, _ = dgetrf(block[rows])
        if not (np.isfinite(lu).all() and np.abs(lu.diagonal()).min() > least):
            raise SingularBasisError("the columns are dependent")
        return cls(rows, columns, block, (lu, pivots))

    def solve(self, right: Array) -> tuple[Array, Array]:
        """The z with ``block z + right = 0`` on the rows, shape (k, m), and the residual of all rows."""
        block, fine = self.block, self.block.size <= EXTENDED
        z = -self.inverse(right[self.rows])
        for _ in range(2):
            left = (block.astype(np.longdouble) @ z + right).astype(float) if fine else block @ z + right
            correction = self.inverse(left[self.rows])
            z -= correction
            left -= block @ correction
        return z, left

    def inverse(self, right: Array, transposed: int = 0) -> Array:
        """The rows' inverse, or its transpose, times `right`."""
        solved: Array = dgetrs(*self._factors, right, trans=transposed)[0] if right.size else right
        return solved
