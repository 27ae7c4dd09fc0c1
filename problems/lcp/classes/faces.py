"""One complementary piece in exact arithmetic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array
from problems.lcp.classes.exact import Indices, IntRow, dot, over_common_denominator, solve
from problems.lcp.classes.simplex import Constraint, Point, at_least, at_most, exactly, feasible_point
from problems.lcp.data.problem import MixedLCP

Bound = tuple[int | None, int | None]
"""(lower, upper), None if absent."""


@frozen
class FacePoint:
    """A solution on one face; `only`: whether it is unique there."""

    x: Point
    w: Point
    only: bool


def face_point(entries: Sequence[IntRow], q: Sequence[int], support: Indices) -> FacePoint | None:
    """A point x >= 0, w = entries x + q >= 0, x zero outside `support` and w zero on it; None if there is none."""
    state = [-1] * len(q)
    for i in support:
        state[i] = 0
    return piece_point(entries, q, [(0, None)] * len(q), 1, state)


def piece_point(
    entries: Sequence[IntRow], q: Sequence[int], bounds: Sequence[Bound], unit: int, state: Sequence[int]
) -> FacePoint | None:
    """A solution with bounds, which are integers over `unit`."""
    inside = [i for i, s in enumerate(state) if s == 0]
    ends = [0 if s == 0 else bounds[i][s > 0] or 0 for i, s in enumerate(state)]
    rows = [[row[j] for j in inside] for row in entries]
    sides = [-unit * c - sum(a * v for a, v in zip(row, ends) if v) for row, c in zip(entries, q)]
    solved = solve([rows[i] for i in inside], [[sides[i]] for i in inside])
    numerators, d = ([], 1) if solved is None else ([value for (value,) in solved[0]], solved[1])
    for value, i in zip(numerators, inside):
        low, high = bounds[i]
        if (low is not None and value < low * d) or (high is not None and value > high * d):
            return None
    signs = [(at_least if s < 0 else at_most)(rows[i], sides[i])
             for i, s in enumerate(state) if s and bounds[i][0] != bounds[i][1]]  # fmt: skip
    if solved is not None and any(dot(row, numerators) < side * d for row, side in signs):
        return None
    found: list[Fraction] = [Fraction(value, d) for value in numerators]
    only = True
    if solved is None:
        equations = [(rows[i], sides[i]) for i in inside]
        units = [[int(j == i) for j in inside] for i in inside]
        signs += [at_least(one, low) for one, i in zip(units, inside) if (low := bounds[i][0]) is not None]
        signs += [at_most(one, high) for one, i in zip(units, inside) if (high := bounds[i][1]) is not None]
        found = _free([*exactly(equations), *signs], len(inside)) or []
        if not found:
            return None
        cone = [*exactly([(row, 0) for row, _ in equations]),
                *((row, 0) for row, side in signs if dot(row, found) == side)]  # fmt: skip
        moves = [side(one, right) for one in units for side, right in ((at_least, 1), (at_most, -1))]
        only = not any(_free([*cone, move], len(inside)) for move in moves)
    x = [Fraction(value, unit) for value in ends]
    for i, part in zip(inside, found):
        x[i] = part / unit
    return FacePoint(tuple(x), tuple(Fraction(dot(row, x) + c) for row, c in zip(entries, q)), only)


def _free(constraints: Sequence[Constraint], m: int) -> list[Fraction] | None:
    """A point of m > 0 numbers of any sign."""
    parts = feasible_point([([*row, *(-v for v in row)], side) for row, side in constraints], 2 * m)
    return None if parts is None else [up - down for up, down in zip(parts, parts[m:])]


def bounds_over(values: Sequence[tuple[float, float]]) -> tuple[list[Bound], int]:
    """Bounds as integers over their least common denominator."""
    exact = [tuple(Fraction(v) if math.isfinite(v) else None for v in pair) for pair in values]
    unit = math.lcm(*(v.denominator for pair in exact for v in pair if v is not None))
    whole = [[None if v is None else int(v * unit) for v in pair] for pair in exact]
    return [(low, high) for low, high in whole], unit


def whole_numbers(problem: MixedLCP) -> tuple[list[list[int]], list[int], int]:
    """A and q as integers, and their scale."""
    n = problem.n
    dense: Array = problem.A.toarray() if sp.issparse(problem.A) else problem.A
    flat, scale = over_common_denominator([Fraction(v) for v in (*dense.ravel().tolist(), *problem.q.tolist())])
    return [flat[i * n : (i + 1) * n] for i in range(n)], flat[n * n :], scale
