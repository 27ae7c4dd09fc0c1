"""The pivots of `almost.AlmostComplementary` as one loop, compiled if the program has imported numba.

An import of numba takes as long as 25,000 numpy pivots of order 50.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from continuation.arrays import Array

Indices = NDArray[np.intp]


def available() -> bool:
    """Whether the program has imported numba."""
    return hasattr(sys.modules.get("numba"), "njit")


@lru_cache(maxsize=1)
def kernel() -> Callable[..., Any]:
    """`pivots`, compiled once and, if possible, cached on disk."""
    numba = sys.modules["numba"]
    try:
        found: Callable[..., Any] = numba.njit(cache=True)(pivots)
    except RuntimeError:  # no such place
        found = numba.njit(pivots)
    return found


def pivots(
    tables: tuple[Array, Array],
    basics: tuple[Indices, Indices],
    nonbasics: tuple[Indices, Indices],
    places: tuple[Indices, Indices],
    firsts: tuple[int, int],
    entering: int,
    stop: tuple[int, int],
    n: int,
    most: int,
    tiny: tuple[float, float],
) -> tuple[int, int, int]:
    """Pivot in place like `Dictionary`; return pivots, entering variable, last to leave (-1 on a ray).

    `tables` belong to two dictionaries, one perhaps empty. `firsts`: the first of each one's variables basic at the
    start.
    """
    zero, tie = tiny
    leaving = 2 * n + 1  # none
    for done in range(most):
        which = 0 if entering < places[0].size and places[0][entering] >= 0 else 1
        table, basic, nonbasic, place = tables[which], basics[which], nonbasics[which], places[which]
        m, k = table.shape
        column = place[entering]
        slopes = table[:, column].copy()
        steepest = largest = 0.0
        for i in range(m):
            steepest = max(steepest, abs(slopes[i]))
            largest = max(largest, abs(table[i, k - 1]))
        limit = -np.inf
        for i in range(m):
            if slopes[i] < -zero * steepest:
                limit = max(limit, (max(table[i, k - 1], 0.0) + tie * largest) / slopes[i])
        tied, number, stops = np.empty(m, np.intp), 0, -1
        for i in range(m):
            if slopes[i] < -zero * steepest and max(table[i, k - 1], 0.0) / slopes[i] >= limit:
                tied[number] = i
                number += 1
                if stops < 0 and (basic[i] == stop[0] or basic[i] == stop[1]):
                    stops = i
        if number == 0:
            return done, entering, -1
        if number > 1 and stops >= 0:
            row = stops
        else:
            # As in `Dictionary._least`.
            for power in range(m):
                if number == 1:
                    break
                p, kept = place[firsts[which] + power], 0
                if p >= 0:
                    low, high = np.inf, -np.inf
                    for j in range(number):
                        ratio = table[tied[j], p] / slopes[tied[j]]
                        low, high = min(low, ratio), max(high, ratio)
                    limit = low + tie * max(max(high, -low), 1.0)
                    for j in range(number):
                        if table[tied[j], p] / slopes[tied[j]] <= limit:
                            tied[kept] = tied[j]
                            kept += 1
                else:
                    for j in range(number):
                        if basic[tied[j]] != firsts[which] + power:
                            tied[kept] = tied[j]
                            kept += 1
                number = kept
            row = tied[0]
        pivot = slopes[row]
        slopes[row] = 0.0
        table[:, column] = 0.0
        for j in range(k):
            moved = 1.0 / pivot if j == column else table[row, j] / -pivot
            if moved != 0.0:
                for i in range(m):
                    table[i, j] += slopes[i] * moved
            table[row, j] = moved
        leaving = basic[row]
        basic[row], nonbasic[column] = entering, leaving
        place[leaving], place[entering] = column, -1
        if leaving == stop[0] or leaving == stop[1]:
            return done + 1, entering, leaving
        entering = leaving + n if leaving < n else leaving - n
    return most, entering, leaving
