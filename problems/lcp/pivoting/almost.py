"""Almost complementary paths: the complement of each leaving variable enters."""

from __future__ import annotations

from enum import Enum

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.pivoting.dictionary import Dictionary

REBUILT_AFTER = 100
"""Pivots, besides the order, that cost as much as a new table."""

PATH_LEFT = -1e-7
"""A basic variable below this, relative to the largest, in an exact table shows that rounding left the path."""


class Ended(Enum):
    """How a path ended."""

    REACHED = "the basis is complementary"
    RAY = "a variable grows without bound"
    PIVOTS = "all pivots are used up"
    PATH_LEFT = "rounding has led off the path"


@define(eq=False)
class AlmostComplementary:
    """A path through bases with one variable of each pair, but for one pair; w_i is variable i, x_i is n + i.

    `dictionaries`: one, or two for a game. `stop`: the path ends when one of these leaves.
    """

    n: int
    dictionaries: tuple[Dictionary, ...]
    entering: int
    stop: frozenset[int]
    pivots: int = 0
    ended: Ended | None = None
    _since: int = field(default=0, init=False)

    def step(self) -> None:
        """One pivot."""
        for now in self.dictionaries:
            column = now.column(self.entering)
            if column is not None:
                break
        assert column is not None
        row = now.first_zero(column, self.stop)
        if row is None:
            self.ended = Ended.RAY
            return
        self.left(now.pivot(row, column))
        self._since += 1
        if self._since >= REBUILT_AFTER + self.n and self.ended is None:
            self._since = 0
            if not all(one.rebuilt() >= PATH_LEFT for one in self.dictionaries):
                self.ended = Ended.PATH_LEFT

    def left(self, leaving: int) -> None:
        """Go on with the complement of the variable that left."""
        self.pivots += 1
        if leaving in self.stop:
            self.ended = Ended.REACHED
        else:
            self.entering = leaving + self.n if leaving < self.n else leaving - self.n

    def run(self, most: int) -> Ended:
        """Pivot to the end, or `most` times in all."""
        while self.ended is None:
            if self.pivots >= most:
                return Ended.PIVOTS
            self.step()
        return self.ended

    @property
    def active(self) -> NDArray[np.bool_]:
        """Which x_i are basic, shape (n,)."""
        basic = np.concatenate([one.basic for one in self.dictionaries])
        mask = np.zeros(self.n, dtype=bool)
        mask[basic[(basic >= self.n) & (basic < 2 * self.n)] - self.n] = True
        return mask

    def values(self) -> Array:
        """X at the basis, shape (n,)."""
        values = np.zeros(2 * self.n + 1)
        for one in self.dictionaries:
            values[one.basic] = one.table[:, -1]
        return np.maximum(values[self.n : 2 * self.n], 0.0)

    def ray(self) -> Array:
        """The change of x along the ray at the end, shape (n,)."""
        direction = np.zeros(2 * self.n + 1)
        for one in self.dictionaries:
            column = one.column(self.entering)
            if column is not None:
                direction[one.basic] = one.table[:, column]
        direction[self.entering] = 1.0
        return direction[self.n : 2 * self.n]
