"""All solutions of a small problem, exactly, from its 2^n faces (3^n pieces for boxes)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from itertools import product

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from problems.lcp.classes.exact import Indices, indices
from problems.lcp.classes.faces import FacePoint, bounds_over, face_point, piece_point, whole_numbers
from problems.lcp.data.problem import LCP, MixedLCP, require_lcp
from problems.lcp.proof.groups import Groups
from problems.lcp.proof.pieces import doubtful

LARGEST_FACES = 14
"""Largest order: 2^14 faces take 1.2 s for one-digit integers."""

PER_PIECE = 3
"""Most unknowns with bounds over the order of an LCP with as many faces."""


@frozen
class ExactSolution:
    """One rational solution: x >= 0, w = A x + q >= 0, x_i w_i = 0, exactly.

    `faces` are those that contain it; `isolated`: whether they hold no other solution.
    """

    x: tuple[Fraction, ...]
    w: tuple[Fraction, ...]
    faces: tuple[Indices, ...]
    isolated: bool

    @property
    def point(self) -> Array:
        """X in floats, correctly rounded, shape (n,)."""
        return np.array([float(v) for v in self.x])


@frozen
class Enumeration:
    """The distinct solutions on all faces: all isolated ones, and a point of each continuum."""

    solutions: tuple[ExactSolution, ...]

    @property
    def solvable(self) -> bool:
        """Whether a solution exists."""
        return bool(self.solutions)

    @property
    def complete(self) -> bool:
        """Whether the list holds all solutions."""
        return all(solution.isolated for solution in self.solutions)

    @property
    def points(self) -> Array:
        """Solutions x in floats, shape (number, n)."""
        return np.array([solution.point for solution in self.solutions])


def solve_by_enumeration(problem: LCP) -> Enumeration:
    """All solutions of LCP(q, A), by exact trial of 2^n faces.

    Parameters
    ----------
    problem : LCP
        Of order `LARGEST_FACES` at most.

    Raises
    ------
    ValueError
        If n is larger.

    Notes
    -----
    The simplex method decides faces with singular submatrices exactly.
    """
    require_lcp(problem)
    entries, q, scale = _integers(problem)
    on_face = {mask: face_point(entries, q, indices(mask)) for mask in range(1 << problem.n)}
    wide = [mask for mask, point in on_face.items() if point is not None and not point.only]
    distinct = {point.x: point for point in on_face.values() if point is not None}
    return Enumeration(tuple(_solution(point, scale, wide) for point in distinct.values()))


@frozen
class Exhaustion:
    """The result of trying faces exactly until one holds a solution.

    Parameters
    ----------
    x : tuple of Fraction, or None
        An exact solution; None proves that none exists.
    faces : int
        Number tried.
    groups : Groups, optional
        Excluded groups with multipliers.
    """

    x: tuple[Fraction, ...] | None
    faces: int
    groups: Groups | None = None

    @property
    def solvable(self) -> bool:
        """Whether a solution exists."""
        return self.x is not None

    @property
    def point(self) -> Array | None:
        """Point x in floats, shape (n,), or None."""
        return None if self.x is None else np.array([_float(value) for value in self.x])


def _float(value: Fraction) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf


def decidable(problem: MixedLCP, order: int = LARGEST_FACES) -> bool:
    """Whether the problem has no more faces than an LCP of order `order`, so that all can be tried."""
    return problem.n <= PER_PIECE * order and problem.pieces <= 1 << order


def exhaust(problem: MixedLCP, *, filtered: bool = False) -> Exhaustion:
    """Decide exactly whether the problem has a solution; ValueError unless `decidable`.

    If `filtered`, skip pieces that floats with error bounds exclude.
    """
    entries, q, _ = _integers(problem)
    bounds, unit = bounds_over(list(zip(problem.lower.tolist(), problem.upper.tolist())))
    states = list(_all_states(problem))
    asked = doubtful(problem, np.array(states, dtype=np.int8).reshape(len(states), problem.n)) if filtered else None
    for tried, state in enumerate(states, 1):
        if asked is not None and not asked[tried - 1]:
            continue
        point = piece_point(entries, q, bounds, unit, state)
        if point is not None:
            return Exhaustion(point.x, tried)
    return Exhaustion(None, len(states))


def _all_states(problem: MixedLCP) -> Iterator[tuple[int, ...]]:
    choices = []
    for low, high in zip(problem.lower[::-1], problem.upper[::-1]):
        inside = () if low == high else (0,)
        choices.append((*((-1,) if low > -math.inf else ()), *inside, *((1,) if inside and high < math.inf else ())))
    return (state[::-1] for state in product(*choices))


def _integers(problem: MixedLCP) -> tuple[list[list[int]], list[int], int]:
    if not decidable(problem):
        raise ValueError(f"problem: expected n <= {LARGEST_FACES} for 2^n faces, found n = {problem.n}")
    return whole_numbers(problem)


def _solution(point: FacePoint, scale: int, wide: list[int]) -> ExactSolution:
    support = sum(1 << i for i, v in enumerate(point.x) if v)
    outside = sum(1 << i for i, v in enumerate(point.w) if v)
    faces = [mask for mask in range(1 << len(point.x)) if mask & support == support and not mask & outside]
    isolated = not any(mask in wide for mask in faces)
    w = tuple(v / scale for v in point.w)
    return ExactSolution(point.x, w, tuple(indices(mask) for mask in faces), isolated)
