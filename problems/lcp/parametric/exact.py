"""Proof of a piecewise linear path in rational numbers.

If two corners satisfy the equations and limits of the piece between them, so does their segment, by convexity.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import lcm
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arguments.checks import expect
from continuation.arrays import SIX_DIGITS, Array
from continuation.path import Path
from continuation.path.path import require_path
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.parametric.along import checked
from problems.lcp.parametric.stairs import Stairs
from problems.lcp.proof.rational import Integers, fractions, full_row_rank, integers, solve_exactly

Exactly = tuple[Fraction, ...]


class UnprovenError(ValueError):
    """The path's corners are not exactly as claimed."""


@frozen
class ExactPath:
    """A piecewise linear path proved in rational numbers: its corners, between which all points are solutions.

    Attributes
    ----------
    points : tuple of tuples of Fraction
        (x, t) of ends and kinks; all points between them are exact solutions.
    pieces : tuple of tuples of int
        For each segment the state of every pair (x_i, w_i): -1 at the lower bound, 0 between, 1 at the upper bound.
    single : bool
        Whether no other path branches off.
    """

    points: tuple[Exactly, ...]
    pieces: tuple[tuple[int, ...], ...]
    single: bool

    @property
    def u(self) -> Array:
        """Points, correctly rounded, shape (m, n + 1)."""
        return np.array([[float(value) for value in point] for point in self.points])


def prove_path(problem: MixedLCP, d: Any, path: Path, level: Any = 0.0) -> ExactPath:
    """Prove a path of `along` in rational arithmetic.

    Parameters
    ----------
    problem : LCP or MixedLCP
    d : array_like, shape (n,)
    path : continuation.Path
        From `along` or an archive.
    level : array_like, shape (n,), or one number
        As for `along`.

    Raises
    ------
    UnprovenError
        If the path is not as claimed.
    """
    problem, slope, levels = checked(problem, d, level)
    require_path(path)
    fine = len(path) > 1 and path.endpoint.u.size == problem.n + 1
    expect(fine, "path", f"two points of {problem.n} unknowns at least", path)
    exact = _Exactly.of(problem, slope, Stairs.of(problem, levels))
    u = path.u
    states = [exact.stairs.states(problem, 0.5 * a[:-1] + 0.5 * b[:-1]) for a, b in pairwise(u)]
    tied = {event.step: event.switches for event in path.kinks}
    held = {0: _mostly(u[1] - u[0]), len(u) - 1: _mostly(u[-1] - u[-2])}
    sides = pairwise([states[0], *states, states[-1]])
    points = [exact.point(*side, u[k], tied.get(k, ()), held.get(k)) for k, side in enumerate(sides)]
    _as_listed(path, points, states)
    single, every = True, np.arange(problem.n)
    for k, state in enumerate(states):
        at_corners = [exact.at_corners(state, points[k + end], k) for end in (0, 1)]
        first, last = k == 0, k == len(states) - 1
        equations = exact.equations(every, state.astype(np.intp) + 1)
        # With independent equations a piece is one line.
        single &= (first or at_corners[0] == 1) and (last or at_corners[1] == 1) and full_row_rank(equations[:, :-1])
    return ExactPath(tuple(points), tuple(tuple(state.tolist()) for state in states), bool(single))


def _as_listed(path: Path, points: list[Exactly], states: list[State]) -> None:
    """Check that events are kinks with their names, and that nothing turns back."""
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
    """Integers over 2^shift: `table` holds [A, d, q], `values` the stairs, with 0 for infinity."""

    stairs: Stairs
    floats: Array
    table: Integers
    values: Integers
    shift: int

    @classmethod
    def of(cls, problem: MixedLCP, d: Array, stairs: Stairs) -> _Exactly:
        floats, n = np.column_stack([problem.A, d, problem.q]), problem.n
        values = np.where(np.isfinite(stairs.values), stairs.values, 0.0)
        whole, shift = integers(np.append(floats.ravel(), values.ravel()))
        table, rest = np.split(np.array(whole, dtype=object), [floats.size])
        return cls(stairs, floats, table.reshape(floats.shape), rest.reshape(6, 3, n), shift)

    def equations(self, pairs: NDArray[np.intp], pieces: NDArray[np.intp]) -> Integers:
        """Each pair's equation on a piece (0, 1, 2): rows [a, b] with a (x, t) + b = 0."""
        rows: Integers = np.zeros((pairs.size, self.table.shape[1]), dtype=object)
        by_w = self.stairs.moves_x[pieces, pairs]
        rows[by_w] = self.table[pairs[by_w]]
        rows[np.flatnonzero(~by_w), pairs[~by_w]] = 1 << self.shift
        rows[:, -2:] -= self.values[1::-1, pieces, pairs].T
        return rows

    def point(self, before: State, after: State, near: Array, tied: tuple[int, ...], held: int | None) -> Exactly:
        """The corner between two pieces where `tied` switch, or a point with one number held."""
        there = before != after
        there[list(tied)] = True
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
        # Farther away another path would be proved.
        if off > SIX_DIGITS * (1.0 + float(np.abs(near).max())):
            raise UnprovenError(f"path: expected a corner near t = {near[-1]:g}, found the nearest one {off:.1e} away")
        return whole

    def at_corners(self, state: State, point: Exactly, stretch: int) -> int:
        """The number of pairs at corners; raises `UnprovenError` if the point is off the piece."""
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
    """The number to hold at an end: t, if it moves."""
    return change.size - 1 if change[-1] != 0.0 else int(np.abs(change).argmax())
