"""A dictionary: basic variables as affine functions of the others, pivoted in place, and its ratio tests.

Ties are broken as if the constants of the first dictionary were raised by eps, eps^2, ..., which no path meets twice.
"""

from __future__ import annotations

from copy import copy

import numpy as np
from attrs import define, field
from numpy.typing import NDArray
from scipy.linalg.blas import dgemm, dger
from scipy.linalg.lapack import dgesv

from continuation.arrays import Array, largest

Indices = NDArray[np.intp]

ZERO_PIVOT = 1e-10
"""An entry below this, relative to its column's largest, counts as rounding: a pivot on it loses the path."""

TIE = 1e-11
"""How far basic variables may fall below zero, relative to the largest constant, if another row leaves than the first.

Rows are tied if any of them may leave so (Harris, "Pivot selection methods of the Devex LP code", Math. Programming 5,
1973). That the leaving row itself is so near to zero is not enough: where it falls slowly, others fall far."""

DELAYED = 32
"""Pivots of a large table that are put into it together, by one product of matrices;"""

LARGE = 100_000
"""one of more entries is large. Microseconds a pivot of a game, one by one and 32 together: 31 and 29 (90,000 entries),
53 and 40 (250,000), 280 and 86 (1e6); of traffic with 5.6e6 entries 2,700 and 460. 16 and 64 together take as long.
Compiled, one by one, they win little beyond it: 30 us with 250,000 entries, 51 with 360,000 where these take 44."""


@define(eq=False)
class Dictionary:
    """``y_basic = table @ (y_nonbasic, 1)``, with the dictionary that it began as.

    `first`, of shape (m, k + 1): The table at the beginning, the constants last. `rows`, of shape (m,), `columns`, of
    shape (k,): Which variables were basic, by consecutive numbers, and which were not. `basic`, `nonbasic`, of the same
    shapes: The same now. `places`: Of each variable among the nonbasic ones, -1 where it is not.
    """

    first: Array
    rows: Indices
    columns: Indices
    basic: Indices = field(init=False)
    nonbasic: Indices = field(init=False)
    _table: Array = field(init=False)
    places: Indices = field(init=False)
    _left: Array = field(init=False)
    _right: Array = field(init=False)
    _waiting: int = field(init=False, default=0)

    def __attrs_post_init__(self) -> None:
        self._table = np.array(self.first, order="F")
        m, k = self.first.shape
        room = DELAYED if m * k > LARGE else 0
        self._left, self._right = np.empty((m, room), order="F"), np.empty((k, room), order="F")
        self.basic, self.nonbasic = self.rows.copy(), self.columns.copy()
        self.places = np.full(1 + max(int(one.max(initial=0)) for one in (self.rows, self.columns)), -1)
        self.places[self.nonbasic] = np.arange(self.nonbasic.size)

    def copied(self) -> Dictionary:
        """Another one that is the same now."""
        other = copy(self)
        other._table, other._left, other._right = self.table.copy(order="F"), self._left.copy(), self._right.copy()
        other.basic, other.nonbasic, other.places = self.basic.copy(), self.nonbasic.copy(), self.places.copy()
        return other

    @property
    def compilable(self) -> bool:
        """Whether numba's pivots are quicker; a single row or column it would not take for a table by columns."""
        return min(self._table.shape) > 1 and self._table.size <= LARGE

    @property
    def table(self) -> Array:
        """With all pivots so far."""
        self._put_in()
        return self._table

    def _put_in(self) -> None:
        w, self._waiting = self._waiting, 0
        if w:
            dgemm(1.0, self._left[:, :w], self._right[:, :w], 1.0, self._table, trans_b=1, overwrite_c=1)

    def entries(self, column: int) -> Array:
        """A column of the table; the constants are column -1.

        Parameters
        ----------
        column : int
        """
        w, entries = self._waiting, self._table[:, column]
        return entries + self._left[:, :w] @ self._right[column, :w] if w else entries

    def column(self, variable: int) -> int | None:
        """Where a variable is among the nonbasic ones; None if it is not."""
        place: int = self.places.item(variable) if variable < self.places.size else -1
        return place if place >= 0 else None

    def pivot(self, row: int, column: int) -> int:
        """Exchange a basic variable for a nonbasic one; the variable that has left the basis.

        `row`, `column`: Their places.
        """
        table, left, right, w = self._table, self._left, self._right, self._waiting
        slopes = self.entries(column)
        pivot = slopes.item(row)
        moved = (table[row] + right[:, :w] @ left[row, :w] if w else table[row]) / -pivot
        moved[column] = 1.0 / pivot
        slopes = slopes.copy()
        slopes[row] = 0.0
        table[:, column] = 0.0
        if left.size:
            # What waits counts no more in the row and the column that are replaced.
            table[row], left[row, :w], right[column, :w] = moved, 0.0, 0.0
            left[:, w], right[:, w] = slopes, moved
            self._waiting += 1
            if self._waiting == DELAYED:
                self._put_in()
        else:
            dger(1.0, slopes, moved, a=table, overwrite_a=1)
            table[row] = moved
        leaving, entering = self.basic.item(row), self.nonbasic.item(column)
        self.basic[row], self.nonbasic[column] = entering, leaving
        self.places[leaving], self.places[entering] = column, -1
        return leaving

    def last_zero(self, column: int) -> int | None:
        """The row that is the last to become nonnegative as a variable grows from minus infinity: it covers the rest.

        `column`: Of the variable. Returns int or None: None if no row grows with the variable.
        """
        slopes, constants = self.entries(column), self.entries(-1)
        growing = np.flatnonzero(slopes > ZERO_PIVOT * np.abs(slopes).max(initial=0.0))
        if growing.size == 0:
            return None
        values, rates = constants[growing], slopes[growing]
        zero = values / rates <= ((values + TIE * largest(constants)) / rates).min()
        return self._least(growing[zero], rates[zero])

    def first_zero(self, column: int, preferred: frozenset[int]) -> int | None:
        """The row that is the first to become zero as a nonbasic variable grows from zero.

        `column`: Of the variable. `preferred`: Basic variables that are taken where they are tied. Returns int or None:
        None if no row falls: the variable grows along a ray.
        """
        slopes, constants = self.entries(column), self.entries(-1)
        falling = (slopes < -ZERO_PIVOT * largest(slopes)).nonzero()[0]
        if falling.size == 0:
            return None
        values, rates = constants[falling], slopes[falling]
        if values.item(values.argmin()) < 0.0:
            values = np.maximum(values, 0.0)
        zero = (values / rates >= ((values + TIE * largest(constants)) / rates).max()).nonzero()[0]
        if zero.size == 1:
            return int(falling[zero[0]])
        tied = falling[zero]
        for row in tied:
            if int(self.basic[row]) in preferred:
                return int(row)
        return self._least(tied, -rates[zero])

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
        self._table, self._waiting = np.asfortranarray(np.vstack([solved, kept])), 0
        self.basic = np.concatenate([self.columns[entered], self.rows[~left]])
        self.nonbasic = np.concatenate([self.rows[left], self.columns[~entered]])
        self.places.fill(-1)
        self.places[self.nonbasic] = np.arange(self.nonbasic.size)
        least: float = self.entries(-1).min() / max(largest(self.entries(-1)), np.finfo(float).tiny)
        return least

    def _least(self, tied: Indices, scale: Array) -> int:
        """Of rows whose constants are tied the one that is least in eps, eps^2, ..., relative to a scale."""
        # The coefficients of eps^k are those of the inverse basis: of a variable of the first one with their sign, and
        # of a row whose basic variable is of the first one 1 at its power, where others have 0.
        places = self.places[self.rows]
        powers = (places >= 0).nonzero()[0]
        own = np.minimum(self.basic[tied] - self.rows[0], places.size)
        ratios = self.table[tied[:, None], places[powers]] / -scale[:, None]
        while tied.size > 1:
            low, high = np.minimum.reduce(ratios), np.maximum.reduce(ratios)
            limit = low + TIE * np.maximum(np.maximum(high, -low), 1.0)
            told = (high > limit).nonzero()[0]
            kept = own >= (powers[told[0]] if told.size else places.size)
            if not kept.any():
                return int(tied[own.argmax()])
            if kept.all():
                if not told.size:
                    break
                kept = ratios[:, told[0]] <= limit[told[0]]
            tied, own, ratios = tied[kept], own[kept], ratios[kept]
        return int(tied[0])
