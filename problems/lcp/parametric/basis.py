"""The square part of the equations on one piece, its inverse updated from kink to kink and refined."""

from __future__ import annotations

import numpy as np
from attrs import define, field
from numpy.typing import NDArray
from scipy.linalg.blas import dger

from continuation.arrays import Array

ROOM = 32
"""Rows by which the inverse grows: it is stored with room, whose zeros cost a little in every product."""

INEXACT = 1e-9
"""A correction by refinement above this, relative to what it corrects, has the inverse computed afresh."""


class SingularBasisError(ValueError):
    """The columns of a basis are dependent."""


@define(eq=False)
class Basis:
    """Rows and columns of [A, d], equally many, and the inverse of their block.

    Attributes
    ----------
    matrix : Array of shape (n, n), in Fortran's order
    rows, columns : lists of int
        Column n is that of t, whose entries are `shares`.
    shares : Array of shape (n,)
    block : Array of shape (n, room), in Fortran's order
        The columns, all rows of them.
    inverse : Array of shape (room, room), in Fortran's order
        With zeros beyond the order of the basis.
    """

    matrix: Array
    shares: Array
    rows: list[int] = field(factory=list)
    columns: list[int] = field(factory=list)
    row_place: NDArray[np.intp] = field(init=False)
    column_place: NDArray[np.intp] = field(init=False)
    block: Array = field(init=False)
    inverse: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        n = self.shares.size
        self.row_place, self.column_place = np.full(n, -1), np.full(n + 1, -1)
        self._allocate(0)
        self.reset(list(self.rows), list(self.columns))

    @property
    def order(self) -> int:
        """How many rows and columns."""
        return len(self.rows)

    def column(self, j: int) -> Array:
        """A column of [A, d], shape (n,)."""
        return self.shares if j == self.shares.size else self.matrix[:, j]

    def reset(self, rows: list[int], columns: list[int]) -> None:
        """Take these rows and columns, and invert their block.

        Raises
        ------
        SingularBasisError
            If it has no inverse.
        """
        self.row_place[:], self.column_place[:] = -1, -1
        self.rows, self.columns = rows, columns
        self.row_place[rows], self.column_place[columns] = np.arange(len(rows)), np.arange(len(columns))
        self._allocate(len(rows))
        for place, j in enumerate(columns):
            self.block[:, place] = self.column(j)
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
        z = np.zeros((self.inverse.shape[0], right.shape[1]), order="F")
        if self.order == 0:
            return z, right.copy()
        rows, k = self.rows, self.order
        padded = np.zeros_like(z)
        left = right.copy()
        for attempt in range(4):
            padded[:k] = left[rows]
            correction = self.inverse @ padded
            z -= correction
            left = self.block @ z + right
            size = np.abs(z).max(axis=0)
            relative = np.abs(correction).max(axis=0) <= INEXACT * size
            if attempt and relative.all():
                break
            if attempt == 2:
                self.invert()
        return z, left

    def enter_both(self, row: int, column: int) -> None:
        """A row and a column more."""
        k = self.order
        if k + 1 > self.inverse.shape[0]:
            self._grow()
        entering = self.column(column)
        self.block[:, k] = entering
        right = np.zeros(self.inverse.shape[0])
        right[:k] = entering[self.rows]
        h = self.inverse @ right
        g = self.block[row, :] @ self.inverse
        pivot = entering[row] - float(self.block[row, :k] @ h[:k])
        self.rows.append(row)
        self.columns.append(column)
        self.row_place[row] = self.column_place[column] = k
        h[k] = g[k] = -1.0
        self._update(1.0 / pivot, h, g)

    def exchange_column(self, leaving: int, entering: int) -> None:
        """One column for another."""
        place = int(self.column_place[leaving])
        column = self.column(entering)
        right = np.zeros(self.inverse.shape[0])
        right[: self.order] = column[self.rows]
        h = self.inverse @ right
        pivot = h[place]
        h[place] -= 1.0
        self._update(-1.0 / pivot, h, self.inverse[place].copy())
        self.block[:, place] = column
        self.columns[place] = entering
        self.column_place[leaving], self.column_place[entering] = -1, place

    def exchange_row(self, leaving: int, entering: int) -> None:
        """One row for another."""
        place = int(self.row_place[leaving])
        g = self.block[entering] @ self.inverse
        pivot = g[place]
        g[place] -= 1.0
        self._update(-1.0 / pivot, self.inverse[:, place].copy(), g)
        self.rows[place] = entering
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
        self.rows[at_row], self.columns[at_column] = self.rows[-1], self.columns[-1]
        self.row_place[self.rows.pop()], self.column_place[self.columns.pop()] = at_row, at_column
        self.row_place[row] = self.column_place[column] = -1

    def share(self, row: int, value: float) -> None:
        """Another coefficient of t in a row that is not among the rows, or is about to enter."""
        self.shares[row] = value
        place = int(self.column_place[self.shares.size])
        if place >= 0:
            self.block[row, place] = value

    def _update(self, factor: float, left: Array, right: Array) -> None:
        dger(factor, left, right, a=self.inverse, overwrite_a=1)

    def _allocate(self, order: int) -> None:
        room = (order // ROOM + 1) * ROOM
        self.block = np.zeros((self.shares.size, room), order="F")
        self.inverse = np.zeros((room, room), order="F")

    def _grow(self) -> None:
        block, inverse, k = self.block, self.inverse, self.order
        self._allocate(max(2 * k, ROOM) if k < 8 * ROOM else k + 4 * ROOM)
        self.block[:, :k], self.inverse[:k, :k] = block[:, :k], inverse[:k, :k]
