"""An index of points."""

from __future__ import annotations

from bisect import bisect, insort
from operator import itemgetter
from typing import Generic, TypeVar

import numpy as np
from attrs import define, field

from continuation.arrays import SIX_DIGITS, Array, generic_vector
from continuation.metric import norm
from continuation.numbers.ends import accumulated

Item = TypeVar("Item")


@define(eq=False)
class PointIndex(Generic[Item]):
    """Items at points, each with its metric; locations of one point agree in six digits, being polished to ten.

    Items are sorted by a . u with a generic vector a; the distance bounds its change, so bisection finds candidates.
    """

    _axis: Array = field(factory=lambda: np.empty(0))
    _reach: float = 0.0
    _sorted: list[tuple[float, int, Array, Array, Item]] = field(factory=list)

    def add(self, u: Array, weights: Array, item: Item) -> None:
        """Add an item."""
        if not self._sorted:
            self._axis = generic_vector(u.size) * np.sqrt(weights)
        self._reach = max(self._reach, SIX_DIGITS * float(np.linalg.norm(self._axis / np.sqrt(weights))))
        insort(self._sorted, (float(self._axis @ u), len(self._sorted), u, weights, item), key=itemgetter(0))

    def near(self, u: Array) -> list[Item]:
        """Items within `SIX_DIGITS` of a point, in order."""
        if not self._sorted:
            return []
        number = float(self._axis @ u)
        reach = self._reach + accumulated(u.size) * float(np.abs(self._axis) @ np.abs(u))
        first, last = (bisect(self._sorted, end, key=itemgetter(0)) for end in (number - reach, number + reach))
        close = sorted(self._sorted[first:last], key=itemgetter(1))
        return [item for _, _, place, weights, item in close if norm(weights, u - place) <= SIX_DIGITS]
