"""A dictionary: basic variables as affine functions of the others, pivoted in place, and its ratio tests.

Ties are broken as if the constants of the first dictionary were raised by eps, eps^2, ..., which no path meets twice.
"""

from __future__ import annotations

import numpy as np
from attrs import define, field
from numpy.typing import NDArray
from scipy.linalg.blas import dger
from scipy.linalg.lapack import dgesv

from continuation.arrays import Array, largest

Indices = NDArray[np.intp]

ZERO = 1e-10
"""An entry below this, relative to its column's largest, counts as rounding: a pivot on it loses the path."""

AT_FIRST = 8
"""Columns by which tied rows are compared first; twice as many next."""

TIE = 1e-11
"""What a basic variable may be above zero, relative to the largest constant, where it counts as zero."""


@define(eq=False)
class Dictionary:
    """``y_basic = table @ (y_nonbasic, 1)``, with the dictionary that it began as.

    Attributes
    ----------
    first : Array of shape (m, k + 1)
        The table at the beginning, the constants last.
    rows, columns : integer arrays of shape (m,), (k,)
        Which variables were basic, and which were not.
    table : Array of shape (m, k + 1)
    basic, nonbasic : integer arrays of shape (m,), (k,)
        The same now.
    """

    first: Array
    rows: Indices
    columns: Indices
    table: Array = field(init=False)
    basic: Indices = field(init=False)
    nonbasic: Indices = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.table = np.array(self.first, order="F")
        self.basic, self.nonbasic = self.rows.copy(), self.columns.copy()

    def column(self, variable: int) -> int | None:
        """Where a variable is among the nonbasic ones; None if it is not."""
        place = int((self.nonbasic == variable).argmax())
        return place if self.nonbasic[place] == variable else None

    def pivot(self, row: int, column: int) -> int:
        """Exchange a basic variable for a nonbasic one; the variable that has left the basis.

        Parameters
        ----------
        row, column : int
            Their places.
        """
        table = self.table
        pivot = table[row, column]
        moved = table[row] / -pivot
        moved[column] = 1.0 / pivot
        slopes = table[:, column].copy()
        slopes[row] = 0.0
        table[:, column] = 0.0
        dger(1.0, slopes, moved, a=table, overwrite_a=1)
        table[row] = moved
        leaving = int(self.basic[row])
        self.basic[row], self.nonbasic[column] = self.nonbasic[column], leaving
        return leaving

    def last_zero(self, column: int) -> int | None:
        """The row that is the last to become nonnegative as a variable grows from minus infinity: it covers the rest.

        Parameters
        ----------
        column : int
            Of the variable.

        Returns
        -------
        int or None
            None if no row grows with the variable.
        """
        slopes, constants = self.table[:, column], self.table[:, -1]
        growing = np.flatnonzero(slopes > ZERO * np.abs(slopes).max(initial=0.0))
        if growing.size == 0:
            return None
        at = constants[growing] / slopes[growing]
        zero = constants[growing] - at.min() * slopes[growing] <= self._tie()
        return self._least(growing[zero], slopes[growing[zero]])

    def first_zero(self, column: int, preferred: frozenset[int]) -> int | None:
        """The row that is the first to become zero as a nonbasic variable grows from zero.

        Parameters
        ----------
        column : int
            Of the variable.
        preferred : set of int
            Basic variables that are taken where they are tied.

        Returns
        -------
        int or None
            None if no row falls: the variable grows along a ray.
        """
        slopes = self.table[:, column]
        falling = (slopes < -ZERO * largest(slopes)).nonzero()[0]
        if falling.size == 0:
            return None
        values, rates = np.maximum(self.table[:, -1][falling], 0.0), -slopes[falling]
        ratios = values / rates
        zero = (values - ratios.min() * rates <= self._tie()).nonzero()[0]
        tied = falling[zero]
        if tied.size == 1:
            return int(tied[0])
        for row in tied:
            if int(self.basic[row]) in preferred:
                return int(row)
        return self._least(tied, rates[zero])

    def rebuilt(self) -> float:
        """Compute the table afresh from the first one; the least constant, relative to the largest; NaN if singular.

        Rounding of the pivots is gone then, and a basic variable that turns out to be negative shows.
        """
        entered = np.isin(self.columns, self.basic)
        now, others = np.flatnonzero(entered), np.flatnonzero(np.append(~entered, True))
        left = np.isin(self.rows, self.nonbasic)
        first, k = self.first, now.size
        solved = np.zeros((0, others.size))
        if k:
            # The rows that left, solved for the variables that entered.
            right = np.hstack([np.eye(k), -first[left][:, others]])
            _, _, solved, singular = dgesv(first[left][:, now], right)
            if singular or not np.isfinite(solved).all():
                return np.nan
        kept = first[~left][:, now] @ solved
        kept[:, k:] += first[~left][:, others]
        self.table = np.asfortranarray(np.vstack([solved, kept]))
        self.basic = np.concatenate([self.columns[entered], self.rows[~left]])
        self.nonbasic = np.concatenate([self.rows[left], self.columns[~entered]])
        least: float = self.table[:, -1].min() / max(self._size(), np.finfo(float).tiny)
        return least

    def _size(self) -> float:
        return largest(self.table[:, -1])

    def _tie(self) -> float:
        return TIE * self._size()

    def _least(self, tied: Indices, scale: Array) -> int:
        """Of rows whose constants are tied the one that is least in eps, eps^2, ..., relative to a scale."""
        if tied.size == 1:
            return int(tied[0])
        # The coefficients of eps^k are those of the inverse basis: of a variable of the first one with their sign.
        place = np.full(int(max(self.rows.max(), self.columns.max())) + 1, -1)
        place[self.nonbasic] = np.arange(self.nonbasic.size)
        places = place[self.rows]
        columns = np.append((places >= 0).nonzero()[0], places.size)
        place[self.rows] = np.arange(places.size)
        place[self.columns] = -1
        power = place[self.basic[tied]]
        at, width = 0, AT_FIRST
        while at < columns.size:
            # Some columns at a time: the first few tell most rows apart.
            now = columns[at : at + width]
            now = now[now < places.size]
            ratios = -self.table[tied[:, None], places[now]] / scale[:, None]
            limit = ratios.min(axis=0) + TIE * np.maximum(1.0, np.abs(ratios).max(axis=0))
            told = (ratios > limit).any(axis=0)
            first = int(told.argmax()) if told.any() else now.size
            # A row whose basic variable is of the first basis has the coefficient 1 at its power, where others have 0.
            until = columns[min(at + first, columns.size - 1)]
            kept = (power < 0) | (power >= until)
            if not kept.any():
                return int(tied[power.argmax()])
            if kept.all():
                if first < now.size:
                    kept = ratios[:, first] <= limit[first]
                    first += 1
                else:
                    first, width = max(first, 1), 2 * width
            tied, scale, power, at = tied[kept], scale[kept], power[kept], at + first
            if tied.size == 1:
                break
        return int(tied[0])
