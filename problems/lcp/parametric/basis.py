"""The square part of the equations on one piece, its inverse updated from kink to kink and refined."""

from __future__ import annotations

import numpy as np
from attrs import define, field
from numpy.typing import NDArray
from scipy.linalg.blas import dgemm, dger

from continuation.arrays import Array, largest

SPARE_ROWS = 32
"""Rows by which the inverse grows, or twice as many: it is stored with room, and products leave out its columns."""

INEXACT = 1e-9
"""A correction by refinement above this, relative to what it corrects, has the inverse computed afresh."""


EXTENDED = 4096
"""Entries up to which what is left is computed in extended precision, which costs 20 us for so many: then refinement
makes kinks exact to round-off whatever the condition, and 10,000 problems of integers (n <= 6) to 1e-14."""


class SingularBasisError(ValueError):
    """The columns of a basis are dependent."""


@define(eq=False)
class Basis:
    """Rows and columns of [A, d], equally many, and the inverse of their block.

    Attributes
    ----------
    matrix : Array of shape (n, n), in Fortran's order
    shares : Array of shape (n,)
        The entries of column n, that of t.
    order : int
        How many rows and columns.
    row_place, column_place : integer arrays of shape (n,), (n + 1,)
        Where a row or column is among those of the basis; -1 if it is not.
    block : Array of shape (n, room), in Fortran's order
        The columns, all rows of them.
    inverse : Array of shape (room, room), in Fortran's order
        With zeros beyond the order of the basis.
    """

    matrix: Array
    shares: Array
    order: int = field(init=False, default=0)
    row_place: NDArray[np.intp] = field(init=False)
    column_place: NDArray[np.intp] = field(init=False)
    block: Array = field(init=False)
    inverse: Array = field(init=False)
    _rows: NDArray[np.intp] = field(init=False)
    _columns: NDArray[np.intp] = field(init=False)

    def __attrs_post_init__(self) -> None:
        n = self.shares.size
        self.row_place, self.column_place = np.full(n, -1), np.full(n + 1, -1)
        self._rows, self._columns = np.zeros(n + 1, dtype=np.intp), np.zeros(n + 1, dtype=np.intp)
        self._allocate(0)

    @property
    def rows(self) -> NDArray[np.intp]:
        """Shape (order,)."""
        return self._rows[: self.order]

    @property
    def columns(self) -> NDArray[np.intp]:
        """Shape (order,)."""
        return self._columns[: self.order]

    def column(self, j: int) -> Array:
        """A column of [A, d], shape (n,)."""
        return self.shares if j == self.shares.size else self.matrix[:, j]

    def reset(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> None:
        """Take these rows and columns, and invert their block.

        Raises
        ------
        SingularBasisError
            If it has no inverse.
        """
        self.row_place[:], self.column_place[:] = -1, -1
        k = self.order = rows.size
        self.rows[:], self.columns[:] = rows, columns
        self.row_place[rows] = self.column_place[columns] = np.arange(k)
        self._allocate(k)
        for place, j in enumerate(columns):
            self.block[:, place] = self.column(int(j))
        self.invert()

    def invert(self) -> None:
        """Compute the inverse afresh.

        Raises
        ------
        SingularBasisError
            If there is none.
        """
        k = self.order
        self.inverse[:] = 0.0
        if k == 0:
            return
        try:
            self.inverse[:k, :k] = np.linalg.inv(self.block[self.rows, :k])
        except np.linalg.LinAlgError:
            raise SingularBasisError("the columns are dependent") from None
        if not np.isfinite(self.inverse).all():
            raise SingularBasisError("the columns are dependent")

    def solve(self, right: Array) -> tuple[Array, Array]:
        """Basic variables z with ``block z + right = 0`` on the rows, and what is left of that on all of them.

        Refined once, or more often after a large correction, and then by an inverse that is computed afresh.

        Parameters
        ----------
        right : Array of shape (n, m)

        Returns
        -------
        z : Array of shape (room, m)
        left : Array of shape (n, m)
        """
        k, rows, m = self.order, self.rows, right.shape[1]
        if k == 0:
            return np.zeros((0, m)), right
        block, inverse = self.block[:, :k], self.inverse[:, :k]
        z = dgemm(-1.0, inverse, right[rows])
        left = dgemm(1.0, block, z[:k], 1.0, right)
        fine = block.size <= EXTENDED
        for attempt in range(3):
            if fine:
                left = (block.astype(np.longdouble) @ z[:k] + right).astype(float, order="F")
            correction = dgemm(1.0, inverse, left[rows])
            z -= correction
            left = dgemm(-1.0, block, correction[:k], 1.0, left, overwrite_c=1)
            if all(largest(correction[:, i]) <= INEXACT * largest(z[:, i]) for i in range(m)):
                break
            if attempt == 1:
                self.invert()
        return z, left

    def enter_both(self, row: int, column: int) -> None:
        """A row and a column more."""
        k = self.order
        if k + 1 > self.inverse.shape[0]:
            self._grow()
        entering = self.column(column)
        self.block[:, k] = entering
        h = self.inverse[:, :k] @ entering[self.rows]
        across, g = self.block[row, :k].copy(), np.empty(k + 1)
        g[:k] = across @ self.inverse[:k, :k]
        pivot = entering[row] - float(across @ h[:k])
        self.order += 1
        self._rows[k], self._columns[k] = row, column
        self.row_place[row] = self.column_place[column] = k
        h[k] = g[k] = -1.0
        self._update(1.0 / pivot, h, g)

    def exchange_column(self, leaving: int, entering: int) -> None:
        """One column for another."""
        place = int(self.column_place[leaving])
        column = self.column(entering)
        h = self.inverse[:, : self.order] @ column[self.rows]
        pivot = h[place]
        h[place] -= 1.0
        self._update(-1.0 / pivot, h, self.inverse[place].copy())
        self.block[:, place] = column
        self._columns[place] = entering
        self.column_place[leaving], self.column_place[entering] = -1, place

    def exchange_row(self, leaving: int, entering: int) -> None:
        """One row for another."""
        place, k = int(self.row_place[leaving]), self.order
        g = self.block[entering, :k] @ self.inverse[:k, :k]
        pivot = g[place]
        g[place] -= 1.0
        self._update(-1.0 / pivot, self.inverse[:, place].copy(), g)
        self._rows[place] = entering
        self.row_place[leaving], self.row_place[entering] = -1, place

    def leave_both(self, row: int, column: int) -> None:
        """A row and a column less."""
        at_row, at_column = int(self.row_place[row]), int(self.column_place[column])
        pivot = self.inverse[at_column, at_row]
        self._update(-1.0 / pivot, self.inverse[:, at_row].copy(), self.inverse[at_column].copy())
        last = self.order - 1
        self.inverse[:, at_row] = self.inverse[:, last]
        self.inverse[at_column] = self.inverse[last]
        self.inverse[:, last] = 0.0
        self.inverse[last] = 0.0
        self.block[:, at_column] = self.block[:, last]
        self.block[:, last] = 0.0
        last_row, last_column = self._rows[last], self._columns[last]
        self._rows[at_row], self._columns[at_column] = last_row, last_column
        self.row_place[last_row], self.column_place[last_column] = at_row, at_column
        self.order = last
        self.row_place[row] = self.column_place[column] = -1

    def share(self, row: int, value: float) -> None:
        """Another coefficient of t in a row that is not among the rows, or is about to enter."""
        self.shares[row] = value
        place = int(self.column_place[self.shares.size])
        if place >= 0:
            self.block[row, place] = value

    def _update(self, factor: float, left: Array, right: Array) -> None:
        k = self.order
        dger(factor, left, right[:k], a=self.inverse[:, :k], overwrite_a=1)

    def _allocate(self, order: int) -> None:
        room = (order // SPARE_ROWS + 1) * SPARE_ROWS
        self.block = np.zeros((self.shares.size, room), order="F")
        self.inverse = np.zeros((room, room), order="F")

    def _grow(self) -> None:
        block, inverse, k = self.block, self.inverse, self.order
        self._allocate(max(2 * k, SPARE_ROWS) if k < 2 * SPARE_ROWS else k + 2 * SPARE_ROWS)
        self.block[:, :k], self.inverse[:k, :k] = block[:, :k], inverse[:k, :k]
