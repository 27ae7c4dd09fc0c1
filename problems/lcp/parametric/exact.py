"""A piecewise linear path proved: its corners in rational numbers, each stretch on one piece, exactly."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
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
from problems.lcp.proof.rational import fractions, full_row_rank, integers, solve_exactly
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
    exact = _Exactly(problem, slope, Stairs.of(problem, levels))
    u = path.u
    states = [exact.stretch(problem, a, b) for a, b in pairwise(u)]
    tied = {event.step: event.switches for event in path.kinks}
    held = [_mostly(u[1] - u[0]), _mostly(u[-1] - u[-2])]
    points = [exact.point(states[0], states[0], u[0], (), held[0])]
    for k, (before, after) in enumerate(pairwise(states), 1):
        points.append(exact.point(before, after, u[k], tied.get(k, ()), None))
    points.append(exact.point(states[-1], states[-1], u[-1], (), held[1]))
    _as_listed(path, points, states)
    single = True
    for k, state in enumerate(states):
        at_corners = [exact.at_corners(state, points[k + end], k) for end in (0, 1)]
        first, last = k == 0, k == len(states) - 1
        single &= (first or at_corners[0] == 1) and (last or at_corners[1] == 1) and exact.is_line(state)
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


class _Exactly:
    """The data as integers over powers of two."""

    def __init__(self, problem: MixedLCP, d: Array, stairs: Stairs) -> None:
        self.n = problem.n
        self.stairs = stairs
        whole, self.shift = integers(np.column_stack([problem.A, d, problem.q]).ravel())
        self.floats, self.q = np.column_stack([problem.A, d]), problem.q
        self.table: NDArray[Any] = np.array(whole, dtype=object).reshape(self.n, self.n + 2)

    def stretch(self, problem: MixedLCP, a: Array, b: Array) -> State:
        """The piece of a stretch, by what is off its bounds in the middle."""
        # What is at a bound is there exactly, at both ends.
        return self.stairs.states(problem, 0.5 * a[:-1] + 0.5 * b[:-1])

    def _fixed(self, state: State) -> Array:
        return self.stairs.fixed[state + 1, np.arange(self.n)]

    def _slopes(self, state: State) -> Array:
        return self.stairs.fixed_slope[state + 1, np.arange(self.n)]

    def _corner(self, near: Array) -> NDArray[np.intp]:
        """Which corner of each pair is the nearer one."""
        x, t = near[:-1], near[-1]
        w = self.floats @ near + self.q
        off = np.abs(np.where(self.stairs.levels, w - t * self.stairs.corner_slope, x - self.stairs.corner_x))
        found: NDArray[np.intp] = off.argmin(axis=0)
        return found

    def _rows(
        self, rows: NDArray[np.intp], columns: list[int], values: list[Fraction], slopes: Array
    ) -> tuple[NDArray[Any], list[Fraction]]:
        """The equations of rows in the columns and t, with the values of all others on the right."""
        left = self.table[np.ix_(rows, np.array([*columns, self.n]))].copy()
        others = [j for j in range(self.n) if values[j] and j not in set(columns)]
        right = []
        for place, i in enumerate(rows):
            share = _fraction(slopes[i]) * (1 << self.shift)
            if share.denominator != 1:
                self.table, self.shift = self.table * share.denominator, self.shift + share.denominator.bit_length() - 1
                return self._rows(rows, columns, values, slopes)
            left[place, -1] -= int(share)
            known = sum((int(self.table[i, j]) * values[j] for j in others), Fraction(0))
            right.append(-known - int(self.table[i, self.n + 1]))
        return left, right

    def point(self, before: State, after: State, near: Array, tied: tuple[int, ...], held: int | None) -> Exactly:
        """The corner between two pieces, of these pairs at least; or the point of a piece with one number held."""
        every = np.arange(self.n)
        moves = [self.stairs.moves_x[state + 1, every] for state in (before, after)]
        there = moves[0] != moves[1]
        there[list(tied)] = True
        moving = moves[0] & moves[1] & ~there
        columns, rows = np.flatnonzero(moving).tolist(), np.flatnonzero(moving | there)
        corner = self._corner(near)
        values = [_fraction(v) for v in np.where(there, self.stairs.corner_x[corner, every], self._fixed(before))]
        slopes = np.where(there, self.stairs.corner_slope[corner, every], self._slopes(before))
        left, right = self._rows(rows, columns, values, slopes)
        columns.append(self.n)
        guess, whole = near[columns], [*values, Fraction(0)]
        if held is not None:
            place, known = columns.index(held), _fraction(near[held])
            right = [b - int(a) * known for a, b in zip(left[:, place], right)]
            left, guess = np.delete(left, place, axis=1), np.delete(guess, place)
            columns.remove(held)
            whole[held] = known
        common = max((value.denominator for value in right), default=1)
        solved = solve_exactly(left * common, [int(value * common) for value in right], guess)
        if solved is None:
            raise UnprovenError(f"path: expected a corner near t = {near[-1]:g}, where its pieces do not meet")
        for j, value in zip(columns, fractions(*solved)):
            whole[j] = value
        off = max(abs(float(a) - b) for a, b in zip(whole, near.tolist()))
        if off > SAME_CORNER * (1.0 + float(np.abs(near).max())):
            raise UnprovenError(f"path: expected a corner near t = {near[-1]:g}, found the nearest one {off:.1e} away")
        return tuple(whole)

    def at_corners(self, state: State, point: Exactly, stretch: int) -> int:
        """How many pairs are at a corner of their graphs in a point of a piece.

        Raises
        ------
        UnprovenError
            If the point is not on the piece.
        """
        *x, t = point
        unit = Fraction(1, 1 << self.shift)
        count = 0
        for i in range(self.n):
            row, s = self.table[i], int(state[i]) + 1
            w = unit * (
                sum((int(row[j]) * x[j] for j in range(self.n) if x[j]), Fraction(0))
                + int(row[self.n]) * t
                + int(row[self.n + 1])
            )
            moved, other = (x[i], w) if self.stairs.moves_x[s, i] else (w, x[i])
            ends = [
                _limit(table[s, i], slopes[s, i], t)
                for table, slopes in (
                    (self.stairs.least, self.stairs.least_slope), (self.stairs.most, self.stairs.most_slope)
                )
            ]  # fmt: skip
            if other != _fraction(self.stairs.fixed[s, i]) + _fraction(self.stairs.fixed_slope[s, i]) * t:
                raise UnprovenError(f"path: pair {i} is off its piece on stretch {stretch}")
            if (ends[0] is not None and moved < ends[0]) or (ends[1] is not None and moved > ends[1]):
                raise UnprovenError(f"path: pair {i} is beyond its limits on stretch {stretch}, if by rounding only")
            count += moved in ends
        return count

    def is_line(self, state: State) -> bool:
        """Whether the equations of a piece are independent, so that all of it is one line."""
        moving = np.flatnonzero(self.stairs.moves_x[state + 1, np.arange(self.n)])
        values = [_fraction(v) for v in self._fixed(state)]
        left, _ = self._rows(moving, moving.tolist(), values, self._slopes(state))
        return full_row_rank(left)


def _mostly(change: Array) -> int:
    """Which number to hold at an end: t, unless that stands still."""
    return change.size - 1 if change[-1] != 0.0 else int(np.abs(change).argmax())


def _fraction(value: float) -> Fraction:
    return Fraction(float(value))


def _limit(value: float, slope: float, t: Fraction) -> Fraction | None:
    return _fraction(value) + _fraction(slope) * t if np.isfinite(value) else None
