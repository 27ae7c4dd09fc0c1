"""All pieces of the solutions of LCP(q + t d, A), by brute force in rational numbers: what `along` is held against.

Needs no rival.
"""

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.status import Status
from problems.lcp import LCP, along

Vector = list[Fraction]


@frozen
class Piece:
    """Solutions ``point + s along``, s between the ends; u = (x, t)."""

    point: Vector
    along: Vector
    least: Fraction | None
    most: Fraction | None

    def at(self, s: Fraction) -> Vector:
        return [p + s * v for p, v in zip(self.point, self.along)]

    @property
    def ends(self) -> list[Vector]:
        return [self.at(s) for s in (self.least, self.most) if s is not None]


@frozen
class Pieces:
    """The pieces that are lines, or points, and the supports of those that may be wider."""

    lines: list[Piece]
    wide: list[tuple[int, ...]]


def all_pieces(A: Array, q: Array, d: Array) -> Pieces:
    """For every support its solutions."""
    n = len(q)
    rows = [[Fraction(v) for v in (*A[i].tolist(), d[i], q[i])] for i in range(n)]
    lines, wide = [], []
    for size in range(n + 1):
        for support in combinations(range(n), size):
            columns = [*support, n]
            solved = _solve([[rows[i][j] for j in columns] + [-rows[i][n + 1]] for i in support], size + 1)
            if solved is None:
                continue
            point, kernel = solved
            if len(kernel) > 1:
                wide.append(support)
                continue
            whole, along = [Fraction(0)] * (n + 1), [Fraction(0)] * (n + 1)
            for place, j in enumerate(columns):
                whole[j], along[j] = point[place], kernel[0][place]
            lines += list(_clipped(rows, whole, along, support, n))
    return Pieces(lines, wide)


def _solve(rows: list[Vector], unknowns: int) -> tuple[Vector, list[Vector]] | None:
    """A solution and the kernel; None if there is no solution."""
    rows, pivots = [list(row) for row in rows], []
    for column in range(unknowns):
        k = len(pivots)
        row = next((i for i in range(k, len(rows)) if rows[i][column]), None)
        if row is None:
            continue
        rows[k], rows[row] = rows[row], rows[k]
        rows[k] = [v / rows[k][column] for v in rows[k]]
        for i in range(len(rows)):
            if i != k and rows[i][column]:
                factor = rows[i][column]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k])]
        pivots.append(column)
    if any(row[-1] for row in rows[len(pivots) :]):
        return None
    point = [Fraction(0)] * unknowns
    for k, column in enumerate(pivots):
        point[column] = rows[k][-1]
    kernel = []
    for free in set(range(unknowns)) - set(pivots):
        vector = [Fraction(0)] * unknowns
        vector[free] = Fraction(1)
        for k, column in enumerate(pivots):
            vector[column] = -rows[k][free]
        kernel.append(vector)
    return point, kernel


def _clipped(rows: list[Vector], point: Vector, along: Vector, support: tuple[int, ...], n: int) -> Iterator[Piece]:
    least: Fraction | None = None
    most: Fraction | None = None
    for i in range(n):
        if i in support:
            value, rate = point[i], along[i]
        else:
            value = sum((a * p for a, p in zip(rows[i], point)), rows[i][n + 1])
            rate = sum((a * v for a, v in zip(rows[i], along)), Fraction(0))
        if rate == 0:
            if value < 0:
                return
            continue
        s = -value / rate
        if rate > 0:
            least = s if least is None else max(least, s)
        else:
            most = s if most is None else min(most, s)
    if least is None or most is None or least <= most:
        yield Piece(point, along, least, most)


def contains(A: Array, q: Array, d: Array, support: tuple[int, ...], u: Array, tolerance: float = 1e-9) -> bool:
    """Whether a point is on the piece of a support."""
    n = len(q)
    x, w = u[:n], A @ u[:n] + q + u[n] * d
    on = np.isin(np.arange(n), support)
    size = 1.0 + float(np.abs(u).max())
    return bool(
        (np.abs(np.where(on, w, x)) <= tolerance * size).all() and (np.where(on, x, w) >= -tolerance * size).all()
    )


def rays_at(pieces: Pieces, u: Array, tolerance: float = 1e-9) -> list[Array]:
    """The directions, of unit length, in which pieces leave a point; each once."""
    found: list[Array] = []
    size = 1.0 + float(np.abs(u).max())
    for piece in pieces.lines:
        point, along = (np.array(v, dtype=float) for v in (piece.point, piece.along))
        s = float((u - point) @ along / (along @ along))
        if np.abs(point + s * along - u).max() > tolerance * size:
            continue
        length = float(np.linalg.norm(along))
        room = tolerance * size / length
        if (piece.least is not None and s < float(piece.least) - room) or (
            piece.most is not None and s > float(piece.most) + room
        ):
            continue
        if piece.most is None or s < float(piece.most) - room:
            found.append(along / length)
        if piece.least is None or s > float(piece.least) + room:
            found.append(-along / length)
    return [v for k, v in enumerate(found) if not any(np.abs(v - other).max() < 1e-9 for other in found[:k])]


ENDS = (Status.REACHED_TARGET, Status.DIVERGED, Status.CLOSED, Status.DEAD_END)
"""What a path may end as; that no other ray leaves a dead end is among what is compared."""


@frozen
class Comparison:
    """A path held against all pieces: what is wrong, if anything, and what was met."""

    wrong: str
    kinks: int
    degenerate: int
    branching: int
    wide: int
    off: float


def compared(problem: LCP, d: Array) -> Comparison:
    """The path from the ray at t = inf on, to its end, against all pieces; kinks on wider pieces are only counted."""
    A, q = problem.A, problem.q
    path = along(problem, d, (np.inf, -np.inf))
    pieces = all_pieces(A, q, d)
    ends = [np.array(end, dtype=float) for piece in pieces.lines for end in piece.ends]

    def on_wide(u: Array) -> bool:
        return any(contains(A, q, d, support, u) for support in pieces.wide)

    kinks = [kink for kink in path.kinks if not on_wide(kink.u)]
    off, branching = 0.0, 0
    wrong = "" if path.status in ENDS else path.message
    for kink in kinks:
        size = 1.0 + float(np.abs(kink.u).max())
        off = max(off, min(float(np.abs(end - kink.u).max()) for end in ends) / size)
        rays = rays_at(pieces, kink.u)
        branching += len(rays) > 2
        if len(rays) != len(kink.rays) or any(np.abs(kink.rays - ray).max(axis=1).min() > 1e-8 for ray in rays):
            wrong = f"{len(kink.rays)} rays at {kink.u}, expected {len(rays)}"
    for a, b in pairwise(path.u):
        length = float(np.linalg.norm(b - a))
        along_it = (b - a) / length
        for end in ends:
            s = float((end - a) @ along_it)
            inside = 1e-9 * (1.0 + length) < s < length - 1e-9 * (1.0 + length)
            if inside and np.abs(a + s * along_it - end).max() < 1e-10 * (1.0 + np.abs(end).max()) and not on_wide(end):
                wrong = f"a kink is missed at {end}"
        middle = 0.5 * (a + b)
        there = LCP(A, q + middle[-1] * d)
        if there.natural_residual(middle[:-1]) > 1e-12 * (1.0 + np.abs(middle).max()):
            wrong = f"no solution at {middle}"
    degenerate = sum(len(kink.switches) > 1 for kink in kinks)
    if path.status is Status.UNRESOLVED_KINK and "goes round" in path.message:
        wrong = wrong.removesuffix(path.message)
    return Comparison(wrong, len(kinks), degenerate, branching, len(path.kinks) - len(kinks), off)
