"""A dictionary: basic variables as affine functions of the others, with pivots and ratio tests.

Ties break as if the first constants were raised by eps, eps^2, ..., so no basis repeats.
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
"""Smaller entries, relative to their column's largest, are rounding: a pivot there loses the path."""

TIE = 1e-11
"""Basic variables that fall below zero by less, relative to the largest constant, are tied (Harris, Math. Programming
5, 1973)."""

DELAYED = 32
"""Pivots of a large table put into it by one product;"""

LARGE = 100_000
"""a table with more entries is large. Microseconds per pivot of a game, singly and 32 together: 31 and 29 (90,000
entries), 280 and 86 (1e6)."""


@define(eq=False)
class Dictionary:
    """``y_basic = table @ (y_nonbasic, 1)``, and the dictionary at the start.

    `first`, (m, k + 1): the first table, constants last. `rows`, `columns`: its basic and nonbasic variables; `basic`,
    `nonbasic`: those now. `places`: indices among the nonbasic, or -1.
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
        """A copy."""
        other = copy(self)
        other._table, other._left, other._right = self.table.copy(order="F"), self._left.copy(), self._right.copy()
        other.basic, other.nonbasic, other.places = self.basic.copy(), self.nonbasic.copy(), self.places.copy()
        return other

    @property
    def table(self) -> Array:
        """Table after all pivots."""
        self._put_in()
        return self._table

    def _put_in(self) -> None:
        w, self._waiting = self._waiting, 0
        if w:
            dgemm(1.0, self._left[:, :w], self._right[:, :w], 1.0, self._table, trans_b=1, overwrite_c=1)

    def entries(self, column: int) -> Array:
        """A column of the table; -1: the constants."""
        w, entries = self._waiting, self._table[:, column]
        return entries + self._left[:, :w] @ self._right[column, :w] if w else entries

    def column(self, variable: int) -> int | None:
        """A variable's index among the nonbasic ones, or None."""
        place: int = self.places.item(variable) if variable < self.places.size else -1
        return place if place >= 0 else None

    def pivot(self, row: int, column: int) -> int:
        """Exchange a row's basic for a column's nonbasic variable; return the former."""
        table, left, right, w = self._table, self._left, self._right, self._waiting
        slopes = self.entries(column)
        pivot = slopes.item(row)
        moved = (table[row] + right[:, :w] @ left[row, :w] if w else table[row]) / -pivot
        moved[column] = 1.0 / pivot
        slopes = slopes.copy()
        slopes[row] = 0.0
        table[:, column] = 0.0
        if left.size:
            # Delayed pivots no longer change the replaced row and column.
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
        """The last row to become nonnegative as the variable rises from minus infinity, or None."""
        slopes, constants = self.entries(column), self.entries(-1)
        growing = np.flatnonzero(slopes > ZERO_PIVOT * np.abs(slopes).max(initial=0.0))
        if growing.size == 0:
            return None
        values, rates = constants[growing], slopes[growing]
        zero = values / rates <= ((values + TIE * largest(constants)) / rates).min()
        return self._least(growing[zero], rates[zero])

    def first_zero(self, column: int, preferred: frozenset[int]) -> int | None:
        """The first row to become zero as the variable grows from zero; None on a ray. `preferred` ones win ties."""
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
        """Recompute the table without rounding; return its least constant, relative to the largest, or NaN."""
        entered = np.isin(self.columns, self.basic)
        now, others = np.flatnonzero(entered), np.flatnonzero(np.append(~entered, True))
        left = np.isin(self.rows, self.nonbasic)
        first, k = self.first, now.size
        solved = np.zeros((0, others.size))
        if k:
            # Solve the rows that left for the variables that entered.
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
        """The tied row that is least, relative to a scale, in eps, eps^2, ..."""
        # The inverse basis holds the coefficients of eps^k; a row's own power has 1.
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
