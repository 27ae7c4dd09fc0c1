"""Linear programs over x >= 0, w = A x + q >= 0 in a dictionary whose last row is the cost: x is 0 to n - 1, w follows.

They guide searches, which check what comes out: so there is no rule against ties but generic costs, and no refactoring.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from continuation.arrays import Array, largest
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.dictionary import Dictionary

ROUNDED_TO_ZERO = 1e-9
"""An entry below this, and a value relative to the largest, is no reason for a pivot: in units in which entries are
about 1."""

PIVOTS_PER_PROGRAM = 50
"""Times the order: of programs of order 20 to 100 none took more than the order itself; without end is none."""


def vertex_at_zero(problem: LCP, costs: Array) -> Dictionary:
    """The dictionary at x = 0, where w may be negative, with positive costs of x.

    `problem`: Dense. `costs` of shape (n,).
    """
    n = problem.n
    table = np.vstack([np.column_stack([problem.A, problem.q]), np.append(costs, 0.0)])
    return Dictionary(table, np.arange(n, 2 * n + 1), np.arange(n))


def infeasible_row(dictionary: Dictionary, fixed: NDArray[np.bool_]) -> int | None:
    """Make what is fixed zero and the rest nonnegative, by the dual simplex method; the row that forbids it.

    -1 where there is such a point, None where there is no end. `dictionary`: Dually feasible; is changed. `fixed`, of
    shape (2n + 1,): Of x, w and the cost.
    """
    n = dictionary.nonbasic.size
    for _ in range(PIVOTS_PER_PROGRAM * n):
        constants = dictionary.entries(-1)[:n]
        wrong: Array = np.where(fixed[dictionary.basic[:n]], np.abs(constants), -constants)
        row = int(wrong.argmax())
        if wrong[row] <= ROUNDED_TO_ZERO * largest(constants):
            return -1
        slopes = dictionary.table[row, :n] if constants[row] < 0.0 else -dictionary.table[row, :n]
        rising = ((slopes > ROUNDED_TO_ZERO) & ~fixed[dictionary.nonbasic]).nonzero()[0]
        if not rising.size:
            return row
        ratios = np.maximum(dictionary.table[n, rising], 0.0) / slopes[rising]
        dictionary.pivot(row, int(rising[ratios.argmin()]))
    return None


def cheapest(dictionary: Dictionary, costs: Array) -> int | None:
    """Go from a feasible vertex to one that is least in other costs, by the simplex method; in how many pivots.

    None where there is no end. `dictionary`: Is changed. `costs`, of shape (2n,): Of x and w, not negative.
    """
    n = dictionary.nonbasic.size
    table, basic = dictionary.table, costs[dictionary.basic[:n]]
    table[n] = basic @ table[:n]
    table[n, :n] += costs[dictionary.nonbasic]
    for pivots in range(PIVOTS_PER_PROGRAM * n):
        reduced = dictionary.table[n, :n]
        column = int(reduced.argmin())
        if reduced[column] > -ROUNDED_TO_ZERO:
            return pivots
        slopes, constants = dictionary.entries(column)[:n], dictionary.entries(-1)[:n]
        falling = (slopes < -ROUNDED_TO_ZERO).nonzero()[0]
        if not falling.size:
            return None
        ratios = np.maximum(constants[falling], 0.0) / -slopes[falling]
        dictionary.pivot(int(falling[ratios.argmin()]), column)
    return None


def point_of(dictionary: Dictionary) -> tuple[Array, Array]:
    """X and w at its vertex, but for what is below zero by rounding."""
    n = dictionary.nonbasic.size
    values = np.zeros(2 * n)
    values[dictionary.basic[:n]] = dictionary.entries(-1)[:n]
    return values[:n], values[n:]
