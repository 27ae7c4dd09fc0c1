"""Exact feasibility of small linear systems: phase one of the simplex method on integers, with Bland's rule."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Literal

from attrs import frozen

Point = tuple[Fraction, ...]


@frozen
class Constraint:
    """row . x = right, or row . x >= right, in integers."""

    row: Sequence[int]
    sense: Literal["=", ">="]
    right: int = 0


def equal(row: Sequence[int], right: int = 0) -> Constraint:
    """Row . x = right."""
    return Constraint(row, "=", right)


def at_least(row: Sequence[int], right: int = 0) -> Constraint:
    """Row . x >= right."""
    return Constraint(row, ">=", right)


def at_most(row: Sequence[int], right: int = 0) -> Constraint:
    """Row . x <= right."""
    return Constraint([-v for v in row], ">=", -right)


def feasible_point(constraints: Sequence[Constraint], n: int) -> Point | None:
    """A point x >= 0, of n numbers, that satisfies every constraint exactly, or None when there is none.

    References
    ----------
    Bland, Mathematics of Operations Research 2 (1977) 103-107: the least-index rule, so the method ends.
    Edmonds, J. Res. Nat. Bur. Standards 71B (1967) 241-245: the pivot in integers with one common denominator.
    """
    table, basis = _start(constraints, n)
    artificial_rows = [row for row, b in zip(table, basis) if b < 0]
    if not artificial_rows:
        return _read(table, basis, 1, n)
    cost = [sum(column) for column in zip(*artificial_rows)]
    denominator = 1
    while cost[-1] > 0:
        entering = next((j for j in range(len(cost) - 1) if cost[j] > 0), None)
        if entering is None:
            return None
        leaving = _ratio_test(table, basis, entering)
        top, pivot = table[leaving], table[leaving][entering]
        for i, row in enumerate(table):
            if i != leaving:
                table[i] = _eliminate(row, top, entering, pivot, denominator)
        cost = _eliminate(cost, top, entering, pivot, denominator)
        denominator, basis[leaving] = pivot, entering
    return _read(table, basis, denominator, n)


def positive_point(constraints: Sequence[Constraint], n: int) -> Point | None:
    """A point x >= 1 (in every component) that satisfies every constraint, or None.

    For homogeneous constraints this decides whether a point x > 0 exists.
    """
    shifted = [Constraint(c.row, c.sense, c.right - sum(c.row)) for c in constraints]
    point = feasible_point(shifted, n)
    return None if point is None else tuple(v + 1 for v in point)


def _start(constraints: Sequence[Constraint], n: int) -> tuple[list[list[int]], list[int]]:
    """Rows [variables, slacks, right-hand side >= 0]; a basis of slacks, and of artificials numbered -1, -2, ..."""
    slacks = sum(c.sense == ">=" for c in constraints)
    table, basis, slack = [], [], 0
    for position, c in enumerate(constraints):
        row = [*c.row, *([0] * slacks), c.right]
        own = -1 - position
        if c.sense == ">=":
            row[n + slack] = -1
            if c.right <= 0:
                own = n + slack
            slack += 1
        if own >= 0 or c.right < 0:
            row = [-v for v in row]
        table.append(row)
        basis.append(own)
    return table, basis


def _ratio_test(table: list[list[int]], basis: list[int], entering: int) -> int:
    """The row that leaves: smallest ratio, then least index (artificial variables, which never return, come first)."""
    best = -1
    for i, row in enumerate(table):
        if row[entering] > 0:
            if best < 0:
                best = i
                continue
            gap = row[-1] * table[best][entering] - table[best][-1] * row[entering]
            if gap < 0 or (gap == 0 and basis[i] < basis[best]):
                best = i
    return best


def _eliminate(row: list[int], top: list[int], entering: int, pivot: int, denominator: int) -> list[int]:
    factor = row[entering]
    if factor == 0:
        return [pivot * v // denominator for v in row]
    return [(pivot * v - factor * t) // denominator for v, t in zip(row, top)]


def _read(table: list[list[int]], basis: list[int], denominator: int, n: int) -> Point:
    x = [Fraction(0)] * n
    for row, b in zip(table, basis):
        if 0 <= b < n:
            x[b] = Fraction(row[-1], denominator)
    return tuple(x)
