"""An index of points."""

from __future__ import annotations

from typing import Generic, TypeVar

import numpy as np
from attrs import define, field

from continuation.arrays import SIX_DIGITS, Array

Item = TypeVar("Item")


@define(eq=False)
class PointIndex(Generic[Item]):
    """Items at points, each with its metric; one point's locations agree in six digits, being polished to ten."""

    _items: list[Item] = field(factory=list)
    _points: Array = field(factory=lambda: np.empty((0, 0)))
    _weights: Array = field(factory=lambda: np.empty((0, 0)))

    def add(self, u: Array, weights: Array, item: Item) -> None:
        """Add an item."""
        self._points = np.vstack([self._points.reshape(-1, u.size), u])
        self._weights = np.vstack([self._weights.reshape(-1, u.size), weights])
        self._items.append(item)

    def near(self, u: Array) -> list[Item]:
        """Items within `SIX_DIGITS` of a point, in order."""
        if not self._items:
            return []
        squares = np.einsum("kn,kn->k", self._weights, (self._points - u) ** 2)
        return [self._items[k] for k in np.flatnonzero(squares <= SIX_DIGITS**2)]
