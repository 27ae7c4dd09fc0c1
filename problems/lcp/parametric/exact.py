"""A piecewise linear path proved: its corners in rational numbers, each stretch on one piece, exactly.

On a piece every pair has one equation in (x, t): x_i, or w_i, is what is fixed there. A corner solves the equations of
both of its pieces; where it is within the limits of both, so is all between two corners, by convexity.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import lcm
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from continuation.path import Path
from continuation.path.path import require_path
from problems.lcp.data.problem import MixedLCP, State, require_problem
from problems.lcp.parametric.along import levels_of
from problems.lcp.parametric.stairs import Stairs
from problems.lcp.proof.rational import Integers, fractions, full_row_rank, integers, solve_exactly
from problems.options import finite_vector

SAME_CORNER = 1e-6
"""How far, relatively, the exact corner may be from a path's: else another path would be proved."""

Exactly = tuple[Fraction, ...]


class UnprovenError(ValueError):
    """The corners of a path are not what is claimed, exactly; the message says where."""


@frozen
class ExactPath:
    """Corners in rational numbers, joined by solutions.

    Attributes
    ----------
    points : tuple of tuples of Fraction
        (x, t) of the two ends and of all kinks, in order. Everything on the straight lines between them solves the
        problem, exactly.
    pieces : tuple of tuples of int
        Of each stretch the state of every pair (-1, 0, 1: below, between and above its two corners).
    single : bool
        Whether nothing else can be followed: each stretch is all that its piece has nearby, and at each kink exactly
        one pair switches, so that two rays meet there.
    """

    points: tuple[Exactly, ...]
    pieces: tuple[tuple[int, ...], ...]
    single: bool

    @property
    def u(self) -> Array:
        """The points in floats, each number correctly rounded, shape (m, n + 1)."""
        return np.array([[float(value) for value in point] for point in self.points])


def prove_path(problem: MixedLCP, d: Any, path: Path, level: Any = 0.0) -> ExactPath:
    """Prove a path that `along` has followed, in rational arithmetic; the floats of A, q and d are taken as they are.

    Parameters
    ----------
    problem : LCP or MixedLCP
    d : array_like, shape (n,)
    path : continuation.Path
        Of `along`, or read from an archive.
    level : array_like, shape (n,), or one number
        As for `along`.

    Returns
    -------
    ExactPath

    Raises
    ------
    UnprovenError
        If the path is not what it seems: a ValueError.
    TypeError, ValueError
        For bad input, naming the argument.
    """
    require_problem(problem)
    require_path(path)
    slope = finite_vector("d", d, problem.n)
    levels = levels_of(level, problem)
    if problem.sparse:
        problem = evolve(problem, A=problem.A.toarray())
    if len(path) < 2 or path.endpoint.u.size != problem.n + 1:
        raise ValueError(f"path: expected two points of {problem.n} unknowns at least, found {path!r}")
    exact = _Exactly.of(problem, slope, Stairs.of(problem, levels))
    u = path.u
    # What is at a bound is there exactly, at both ends.
    states = [exact.stairs.states(problem, 0.5 * a[:-1] + 0.5 * b[:-1]) for a, b in pairwise(u)]
    tied = {event.step: event.switches for event in path.kinks}
    points = [exact.point(states[0], states[0], u[0], held=_mostly(u[1] - u[0]))]
    for k, (before, after) in enumerate(pairwise(states), 1):
        points.append(exact.point(before, after, u[k], tied.get(k, ())))
    points.append(exact.point(states[-1], states[-1], u[-1], held=_mostly(u[-1] - u[-2])))
    _as_listed(path, points, states)
    single, every = True, np.arange(problem.n)
    for k, state in enumerate(states):
        at_corners = [exact.at_corners(state, points[k + end], k) for end in (0, 1)]
        first, last = k == 0, k == len(states) - 1
        equations = exact.equations(every, state.astype(np.intp) + 1)
        # Where the equations of a piece are independent all of it is one line.
        single &= (first or at_corners[0] == 1) and (last or at_corners[1] == 1) and full_row_rank(equations[:, :-1])
    return ExactPath(tuple(points), tuple(tuple(state.tolist()) for state in states), bool(single))


def _as_listed(path: Path, points: list[Exactly], states: list[State]) -> None:
    """That the events of the path are its kinks, called what they are, and that it goes on in each of its points."""
    kinks = {event.step: event for event in path.kinks}
    wrong = [e for e in path.events if kinks.get(e.step) is not e or not 0 < e.step < len(path) - 1]
    wrong += [e for e in path.kinks if not np.array_equal(e.u, path.u[e.step])]
    if wrong:
        raise UnprovenError(f"path: expected one event at each kink, found {wrong[0].name!r} at t = {wrong[0].lam:g}")
    for k, (a, b, c) in enumerate(zip(points, points[1:], points[2:]), 1):
        before, after = (tuple(q - p for p, q in zip(*pair)) for pair in ((a, b), (b, c)))
        same, rate = np.array_equal(states[k - 1], states[k]), before[-1] * after[-1]
        if same and sum(p * q for p, q in zip(before, after)) <= 0:
            raise UnprovenError(f"path: it turns back on its own piece at t = {float(b[-1]):g}")
        if k not in kinks and not same:
            raise UnprovenError(f"path: expected a kink at t = {float(b[-1]):g}, found none in its list")
        if k in kinks and kinks[k].name == ("kink" if rate < 0 else "turning kink" if rate > 0 else None):
            raise UnprovenError(
                f"path: t does not {'turn' if rate > 0 else 'go on'} in the kink at t = {float(b[-1]):g}"
            )


@frozen(eq=False)
class _Exactly:
    """The data as integers over 2^shift: `table` the rows of [A, d, q], `values` those of the stairs, 0 for infinity.

    `floats` of shape (n, n + 2): [A, d, q].
    """

    stairs: Stairs
    floats: Array
    table: Integers
    values: Integers
    shift: int

    @classmethod
    def of(cls, problem: MixedLCP, d: Array, stairs: Stairs) -> _Exactly:
        """Of the floats of a dense problem, as they are."""
        floats, n = np.column_stack([problem.A, d, problem.q]), problem.n
        values = np.where(np.isfinite(stairs.values), stairs.values, 0.0)
        whole, shift = integers(np.append(floats.ravel(), values.ravel()))
        table, rest = np.split(np.array(whole, dtype=object), [floats.size])
        return cls(stairs, floats, table.reshape(floats.shape), rest.reshape(6, 3, n), shift)

    def equations(self, pairs: NDArray[np.intp], pieces: NDArray[np.intp]) -> Integers:
        """What is fixed of each pair on a piece (0, 1, 2): rows [a, b] with a (x, t) + b = 0, shape (m, n + 2)."""
        rows: Integers = np.zeros((pairs.size, self.table.shape[1]), dtype=object)
        by_w = self.stairs.moves_x[pieces, pairs]
        rows[by_w] = self.table[pairs[by_w]]
        rows[np.flatnonzero(~by_w), pairs[~by_w]] = 1 << self.shift
        rows[:, -2:] -= self.values[1::-1, pieces, pairs].T
        return rows

    def point(
        self, before: State, after: State, near: Array, tied: tuple[int, ...] = (), held: int | None = None
    ) -> Exactly:
        """The corner between two pieces, of these pairs at least; or the point of a piece with one number held."""
        there = before != after
        there[list(tied)] = True
        # At the nearer corner of a pair two of its pieces meet.
        x, w = near[:-1], self.floats @ np.append(near, 1.0)
        corners = np.where(self.stairs.levels, w - near[-1] * self.stairs.corner_slope, x - self.stairs.corner_x)
        corner, at, rest = np.abs(corners).argmin(axis=0), np.flatnonzero(there), np.flatnonzero(~there)
        pieces = np.concatenate([before[rest].astype(np.intp) + 1, corner[at], corner[at] + 1])
        rows = self.equations(np.concatenate([rest, at, at]), pieces)
        if held is not None:
            number, one = Fraction(float(near[held])), np.zeros((1, rows.shape[1]), dtype=object)
            one[0, held], one[0, -1] = number.denominator, -number.numerator
            rows = np.concatenate([rows, one])
        solved = solve_exactly(rows[:, :-1], (-rows[:, -1]).tolist(), near)
        if solved is None:
            raise UnprovenError(f"path: expected a corner near t = {near[-1]:g}, where its pieces do not meet")
        whole = fractions(*solved)
        off = max(abs(float(a) - b) for a, b in zip(whole, near.tolist()))
        if off > SAME_CORNER * (1.0 + float(np.abs(near).max())):
            raise UnprovenError(f"path: expected a corner near t = {near[-1]:g}, found the nearest one {off:.1e} away")
        return whole

    def at_corners(self, state: State, point: Exactly, stretch: int) -> int:
        """How many pairs are at a corner of their graphs in a point of a piece.

        Raises
        ------
        UnprovenError
            If the point is not on the piece.
        """
        unit, piece = lcm(*(value.denominator for value in point)), (state.astype(np.intp) + 1, np.arange(state.size))
        whole: Integers = np.array([int(value * unit) for value in point] + [unit], dtype=object)
        x, w, moves_x = whole[:-2] * (1 << self.shift), self.table @ whole, self.stairs.moves_x[piece]
        moved, other = np.where(moves_x, x, w), np.where(moves_x, w, x)
        fixed, least, most = (self.values[k][piece] * unit + self.values[m][piece] * whole[-2]
                              for k, m in ((0, 1), (2, 4), (3, 5)))  # fmt: skip
        low, high = np.isfinite(self.stairs.values[2:4])[:, *piece]
        if (other != fixed).any():
            raise UnprovenError(f"path: pair {int(np.argmax(other != fixed))} is off its piece on stretch {stretch}")
        beyond = (low & (moved < least)) | (high & (moved > most))
        if beyond.any():
            i = int(np.argmax(beyond))
            raise UnprovenError(f"path: pair {i} is beyond its limits on stretch {stretch}, if by rounding only")
        return int(((low & (moved == least)) | (high & (moved == most))).sum())

def _mostly(change: Array) -> int:
    """Which number to hold at an end: t, unless that stands still."""
    return change.size - 1 if change[-1] != 0.0 else int(np.abs(change).argmax())
