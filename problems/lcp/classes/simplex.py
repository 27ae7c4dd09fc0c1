"""Exact feasibility of small linear systems: the simplex method in integers with Bland's rule.

The least value of an added variable is zero if the system is feasible.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

Point = tuple[Fraction, ...]

Constraint = tuple[Sequence[int], int]
"""(row, right): row . x >= right, in integers."""


def at_least(row: Sequence[int], right: int = 0) -> Constraint:
    """Row . x >= right."""
    return row, right


def at_most(row: Sequence[int], right: int = 0) -> Constraint:
    """Row . x <= right."""
    return [-v for v in row], -right


def exactly(constraints: Sequence[Constraint]) -> list[Constraint]:
    """Constraints as equations, by an upper limit on their sum."""
    rows, rights = [row for row, _ in constraints], [right for _, right in constraints]
    return [*constraints, at_most([sum(column) for column in zip(*rows)], sum(rights))]


def feasible_point(constraints: Sequence[Constraint], n: int) -> Point | None:
    """A point x >= 0, of n numbers, that satisfies every constraint, or None.

    References
    ----------
    Bland, Mathematics of Operations Research 2 (1977) 103-107: the least-index rule.
    Edmonds, J. Res. Nat. Bur. Standards 71B (1967) 241-245: pivots in integers with a common denominator.
    """
    worst = max(range(len(constraints)), key=lambda i: constraints[i][1], default=0)
    if not constraints or constraints[worst][1] <= 0:
        return (Fraction(0),) * n
    table = [[*row, 1, -right] for row, right in constraints]
    free, basic = [*range(1, n + 1), 0], list(range(n + 1, n + 1 + len(table)))
    denominator = exchange(table, basic, free, worst, n, 1)
    while 0 in basic and table[basic.index(0)][-1] > 0:
        falling = [j for j, v in enumerate(table[basic.index(0)][:-1]) if v < 0]
        if not falling:
            return None
        entering = min(falling, key=free.__getitem__)
        leaving = _leaving(table, basic, entering)
        denominator = exchange(table, basic, free, leaving, entering, denominator)
    found = dict(zip(basic, table))
    return tuple(Fraction(found[i][-1], denominator) if i in found else Fraction(0) for i in range(1, n + 1))


def positive_point(constraints: Sequence[Constraint], n: int) -> Point | None:
    """A point x >= 1 that satisfies every constraint, or None."""
    point = feasible_point([(row, right - sum(row)) for row, right in constraints], n)
    return None if point is None else tuple(v + 1 for v in point)


def _leaving(table: list[list[int]], basic: list[int], entering: int) -> int:
    best = -1
    for i, row in enumerate(table):
        if row[entering] < 0:
            gap = -1 if best < 0 else table[best][-1] * row[entering] - row[-1] * table[best][entering]
            if gap < 0 or (gap == 0 and basic[i] < basic[best]):
                best = i
    return best


def exchange(
    table: list[list[int]], basic: list[int], free: list[int], leaving: int, entering: int, denominator: int
) -> int:
    """Exchange a basic and a free variable: pivot in integers over the new denominator, which is returned."""
    top = table[leaving]
    pivot, sign = abs(top[entering]), 1 if top[entering] > 0 else -1
    for i, row in enumerate(table):
        factor = row[entering]
        if i != leaving:
            table[i] = [(pivot * v - sign * factor * t) // denominator for v, t in zip(row, top)]
            table[i][entering] = sign * factor
    table[leaving] = [-sign * t for t in top]
    table[leaving][entering] = sign * denominator
    basic[leaving], free[entering] = free[entering], basic[leaving]
    return pivot
