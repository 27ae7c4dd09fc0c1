"""One complementary piece in exact arithmetic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array
from problems.lcp.classes.exact import Indices, IntRow, consistent, over_common_denominator, solve
from problems.lcp.classes.simplex import Point, at_least, at_most, exactly, feasible_point
from problems.lcp.data.problem import MixedLCP

Bound = tuple[int | None, int | None]
"""(lower, upper), None if absent."""


@frozen
class FacePoint:
    """A solution on one face; `only`: whether it is unique there."""

    x: Point
    w: Point
    only: bool


@frozen
class Piece:
    """The conditions of one piece.

    `columns` of shape (n, number inside). `constants`: The rows for zero x inside. `below`, `above`: Outside indices
    with w_i >= 0, or w_i <= 0. `bounds`: Inside.
    """

    columns: list[list[int]]
    constants: list[int]
    inside: Indices
    below: list[int]
    above: list[int]
    bounds: list[Bound]

    def w(self, inside: Sequence[Fraction]) -> Point:
        """The rows for given x inside."""
        rows = zip(self.columns, self.constants)
        return tuple(sum((a * v for a, v in zip(row, inside)), Fraction(0)) + constant for row, constant in rows)


def face_point(entries: Sequence[IntRow], q: Sequence[int], support: Indices) -> FacePoint | None:
    """A point x, w >= 0, w = entries x + q, with x zero outside `support` and w zero on it.

    None proves that there is none.
    """
    rest = [i for i in range(len(q)) if i not in support]
    columns = [[row[j] for j in support] for row in entries]
    return _point(Piece(columns, list(q), support, rest, [], [(0, None)] * len(support)), [0] * len(q), 1)


def piece_point(
    entries: Sequence[IntRow], q: Sequence[int], bounds: Sequence[Bound], unit: int, state: Sequence[int]
) -> FacePoint | None:
    """A solution with bounds, integers over `unit`; states -1 and 1 put x_i at its lower and upper one."""
    inside = tuple(i for i, s in enumerate(state) if s == 0)
    ends = [0 if s == 0 else bounds[i][s > 0] for i, s in enumerate(state)]
    values = [value if value is not None else 0 for value in ends]
    constants = [sum(a * v for a, v in zip(row, values) if v) + unit * c for row, c in zip(entries, q)]
    free = [bounds[i][0] != bounds[i][1] for i in range(len(q))]
    below = [i for i, s in enumerate(state) if s < 0 and free[i]]
    above = [i for i, s in enumerate(state) if s > 0 and free[i]]
    columns = [[row[j] for j in inside] for row in entries]
    return _point(Piece(columns, constants, inside, below, above, [bounds[i] for i in inside]), values, unit)


def _point(piece: Piece, values: list[int], unit: int) -> FacePoint | None:
    solved = solve([piece.columns[i] for i in piece.inside], [[-piece.constants[i]] for i in piece.inside])
    found = _singular_piece(piece) if solved is None else _nonsingular_piece(piece, *solved)
    if found is None:
        return None
    inside, w, only = found
    x = [Fraction(value) for value in values]
    for place, value in zip(piece.inside, inside, strict=True):
        x[place] = value
    if unit != 1:
        x, w = [value / unit for value in x], tuple(value / unit for value in w)
    return FacePoint(tuple(x), w, only)


def _nonsingular_piece(piece: Piece, columns: Sequence[Sequence[int]], d: int) -> tuple[Point, Point, bool] | None:
    numerators = [column[0] for column in columns]
    if any(
        (low is not None and v < low * d) or (high is not None and v > high * d)
        for v, (low, high) in zip(numerators, piece.bounds)
    ):
        return None
    slack = {
        i: sum(a * v for a, v in zip(piece.columns[i], numerators)) + piece.constants[i] * d
        for i in range(len(piece.constants))
        if i not in piece.inside
    }
    if any(slack[i] < 0 for i in piece.below) or any(slack[i] > 0 for i in piece.above):
        return None
    w = tuple(Fraction(slack.get(i, 0), d) for i in range(len(piece.constants)))
    return tuple(Fraction(v, d) for v in numerators), w, True


def _singular_piece(piece: Piece) -> tuple[Point, Point, bool] | None:
    """A point by linear programming; unknowns that may be negative are differences."""
    if not consistent([[*piece.columns[i], -piece.constants[i]] for i in piece.inside]):
        return None
    m, parts = len(piece.inside), [j for j, (low, _) in enumerate(piece.bounds) if low != 0]

    def split(row: Sequence[int]) -> list[int]:
        return [*row, *(-row[j] for j in parts)]

    rows, sides = [split(row) for row in piece.columns], [-constant for constant in piece.constants]
    system = exactly([at_least(rows[i], sides[i]) for i in piece.inside])
    system += [at_least(rows[i], sides[i]) for i in piece.below] + [at_most(rows[i], sides[i]) for i in piece.above]
    for j, (low, high) in enumerate(piece.bounds):
        unit = split([int(k == j) for k in range(m)])
        system += [at_least(unit, low)] if low else []
        system += [at_most(unit, high)] if high is not None else []
    found = feasible_point(system, m + len(parts))
    if found is None:
        return None
    inside = list(found[:m])
    for j, part in zip(parts, found[m:]):
        inside[j] -= part
    w = piece.w(inside)
    return tuple(inside), w, not _can_move(piece, inside, w)


def _can_move(piece: Piece, x: Sequence[Fraction], w: Point) -> bool:
    """Whether a direction d = up - down leads to other solutions."""
    m = len(piece.inside)

    def split(row: Sequence[int]) -> list[int]:
        return [*row, *(-v for v in row)]

    cone = exactly([at_least(split(piece.columns[i])) for i in piece.inside])
    cone += [at_least(split(piece.columns[i])) for i in piece.below if w[i] == 0]
    cone += [at_most(split(piece.columns[i])) for i in piece.above if w[i] == 0]
    units = [split([int(j == k) for j in range(m)]) for k in range(m)]
    cone += [at_least(units[k]) for k in range(m) if x[k] == piece.bounds[k][0]]
    cone += [at_most(units[k]) for k in range(m) if x[k] == piece.bounds[k][1]]
    moves = [side(unit, right) for unit in units for side, right in ((at_least, 1), (at_most, -1))]
    return any(feasible_point([*cone, move], 2 * m) is not None for move in moves)


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
