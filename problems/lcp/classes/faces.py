"""One face of the linear complementarity problem: x zero outside an index set, w zero inside it."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from attrs import frozen

from problems.lcp.classes.exact import Indices, IntRow, solve
from problems.lcp.classes.simplex import Constraint, Point, at_least, at_most, equal, feasible_point


@frozen
class FacePoint:
    """A solution found on one face.

    Parameters
    ----------
    x, w : tuple of Fraction, length n
    only : bool
        Whether the face holds no other solution.
    """

    x: Point
    w: Point
    only: bool


def face_point(entries: Sequence[IntRow], q: Sequence[int], support: Indices) -> FacePoint | None:
    """A point x >= 0, w = entries x + q >= 0 with x zero outside `support` and w zero on it, or None if there is none.

    A nonsingular principal submatrix gives the only candidate; a singular one leaves a linear feasibility problem,
    solved exactly. So None is a proof.
    """
    n = len(q)
    rest = [i for i in range(n) if i not in support]
    block = [[entries[i][j] for j in support] for i in support]
    solved = solve(block, [[-q[i]] for i in support])
    if solved is None:
        return _singular_face(entries, q, support, rest)
    columns, d = solved
    numerators = [column[0] for column in columns]
    if any(v < 0 for v in numerators):
        return None
    slack = [sum(entries[i][j] * v for j, v in zip(support, numerators)) + q[i] * d for i in rest]
    if any(v < 0 for v in slack):
        return None
    x = _spread(n, support, [Fraction(v, d) for v in numerators])
    return FacePoint(x, _spread(n, rest, [Fraction(v, d) for v in slack]), True)


def _spread(n: int, places: Sequence[int], values: Sequence[Fraction]) -> Point:
    out = [Fraction(0)] * n
    for place, value in zip(places, values, strict=True):
        out[place] = value
    return tuple(out)


def _singular_face(
    entries: Sequence[IntRow], q: Sequence[int], support: Indices, rest: Sequence[int]
) -> FacePoint | None:
    columns = [[row[j] for j in support] for row in entries]
    system = [equal(columns[i], -q[i]) for i in support] + [at_least(columns[i], -q[i]) for i in rest]
    found = feasible_point(system, len(support))
    if found is None:
        return None
    n = len(q)
    x = _spread(n, support, found)
    w = tuple(sum((a * v for a, v in zip(row, x)), Fraction(0)) + q_i for row, q_i in zip(entries, q))
    return FacePoint(x, w, not _can_move(columns, support, rest, x, w))


def _can_move(columns: Sequence[IntRow], support: Indices, rest: Sequence[int], x: Point, w: Point) -> bool:
    """Whether a direction d != 0 leads from x to other solutions of the face (d = up - down, both nonnegative)."""
    m = len(support)

    def split(row: IntRow) -> list[int]:
        return [*row, *(-v for v in row)]

    cone: list[Constraint] = [equal(split(columns[i])) for i in support]
    cone += [at_least(split(columns[i])) for i in rest if w[i] == 0]
    units = [split([int(j == k) for j in range(m)]) for k in range(m)]
    cone += [at_least(units[k]) for k in range(m) if x[support[k]] == 0]
    moves = [side(unit, right) for unit in units for side, right in ((at_least, 1), (at_most, -1))]
    return any(feasible_point([*cone, move], 2 * m) is not None for move in moves)
