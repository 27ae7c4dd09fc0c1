"""Points that are looked for again, among many: by one number first, then in the metric of each."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import Any, Generic, TypeVar

import numpy as np
from attrs import define, field

from continuation.arrays import Array, generic_vector
from continuation.metric import norm

SAME_PLACE = 1e-6
"""How far apart, in extents of the path, one point may be located on two branches: they are polished to 1e-10."""

PRODUCT_ROUNDING = 1e-12
"""Of the sum of a product of vectors, far more than its rounding."""

Item = TypeVar("Item")


@define(eq=False)
class PointIndex(Generic[Item]):
    """Items at points, each with the metric there.

    All are sorted by the number a . u, with a in general position. By the inequality of Cauchy and Schwarz, numbers of
    points differ by at most |a / w^(1/2)| times their distance in the metric w: an item among thousands is found by
    bisection and a look at one or two.
    """

    _axis: Array | None = None
    _reach: float = 0.0
    _numbers: list[float] = field(factory=list)
    _order: list[int] = field(factory=list)
    _items: list[tuple[Array, Array, Item]] = field(factory=list)

    def add(self, u: Array, weights: Array, item: Item) -> None:
        """Put an item at a point."""
        if self._axis is None:
            self._axis = generic_vector(u.size) * np.sqrt(weights)
        self._reach = max(self._reach, SAME_PLACE * float(np.linalg.norm(self._axis / np.sqrt(weights))))
        number = float(self._axis @ u)
        at = bisect_right(self._numbers, number)
        self._numbers.insert(at, number)
        self._order.insert(at, len(self._items))
        self._items.append((u, weights, item))

    def near(self, u: Array) -> list[Item]:
        """The items within `SAME_PLACE` of a point, each in its metric, in the order in which they were added."""
        if self._axis is None:
            return []
        number = float(self._axis @ u)
        reach = self._reach + PRODUCT_ROUNDING * float(np.abs(self._axis) @ np.abs(u))
        some = slice(bisect_left(self._numbers, number - reach), bisect_right(self._numbers, number + reach))
        close: list[Any] = [self._items[k] for k in sorted(self._order[some])]
        return [item for place, weights, item in close if norm(weights, u - place) <= SAME_PLACE]
