"""Lemke's method on many small LCPs at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.pivoting.dictionary import ZERO_PIVOT

MOST_PIVOTS = 3
"""Most pivots over the order, plus ten: no Gaussian path ends after 3 n + 10. Cycles would delay others."""


def lemke_bases(A: Array, q: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The x that are basic at the end of Lemke's path with covering vector e, and whether t left the basis.

    The least index breaks ties, so paths may cycle. A (k, n, n), q (k, n).
    """
    k, n = q.shape
    t = 2 * n
    active, ended = np.zeros((k, n), dtype=bool), q.min(axis=1) >= 0.0
    which = np.flatnonzero(~ended)
    table = np.empty((which.size, n, n + 2))
    table[:, :, :n], table[:, :, n], table[:, :, n + 1] = A[which], 1.0, q[which]
    basic = np.tile(np.arange(n), (which.size, 1))
    nonbasic = np.tile(np.arange(n, t + 1), (which.size, 1))
    row, column = table[:, :, -1].argmin(axis=1), np.full(which.size, n)
    for _ in range(MOST_PIVOTS * n + 10):
        leaving = _pivot(table, basic, nonbasic, row, column)
        done = leaving == t
        if done.any():
            here = np.flatnonzero(done)
            is_x = (basic[here] >= n) & (basic[here] < t)
            index, place = np.nonzero(is_x)
            active[which[here[index]], basic[here][index, place] - n] = True
            ended[which[here]] = True
        entering = np.where(leaving < n, leaving + n, leaving - n)
        column = (nonbasic == entering[:, None]).argmax(axis=1)
        row, blocked = _first_zero(table, basic, column, t)
        go_on = blocked & ~done
        if not go_on.all():
            table, basic, nonbasic, which = table[go_on], basic[go_on], nonbasic[go_on], which[go_on]
            row, column = row[go_on], column[go_on]
        if not which.size:
            break
    return active, ended


def _pivot(
    table: Array,
    basic: NDArray[np.intp],
    nonbasic: NDArray[np.intp],
    row: NDArray[np.intp],
    column: NDArray[np.intp],
) -> NDArray[np.intp]:
    each = np.arange(len(table))
    moved = table[each, row]
    pivot = moved[each, column]
    moved /= -pivot[:, None]
    moved[each, column] = 1.0 / pivot
    slopes = table[each, :, column]
    slopes[each, row] = 0.0
    table[each, :, column] = 0.0
    table += slopes[:, :, None] * moved[:, None, :]
    table[each, row] = moved
    leaving = basic[each, row]
    basic[each, row], nonbasic[each, column] = nonbasic[each, column], leaving
    return leaving


def _first_zero(
    table: Array, basic: NDArray[np.intp], column: NDArray[np.intp], t: int
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """The rows that become zero first, and whether any does."""
    each = np.arange(len(table))
    slopes, constants = -table[each, :, column], table[:, :, -1]
    falling = slopes > ZERO_PIVOT * np.abs(slopes).max(axis=1)[:, None]
    ratios = np.where(falling, np.maximum(constants, 0.0) / np.where(falling, slopes, 1.0), np.inf)
    row = ratios.argmin(axis=1)
    last = (basic == t).argmax(axis=1)
    tied = ratios[each, last] <= ratios[each, row]
    return np.where(tied, last, row), falling.any(axis=1)
