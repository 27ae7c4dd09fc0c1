"""The first zero of any switch on an arc: all of them are watched together, and located one by one."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, generic_vector
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.pieces import Pieces, Signs, SwitchError
from continuation.events.locate import AT_ROUND_OFF, MONITOR_PLACES, NEARLY_ZERO, _descent, _root
from continuation.events.roots import zero_between
from continuation.point.arc import Arc, cubic_between, position
from continuation.point.linearization import Linearization, linearize, relinearize
from continuation.point.projection import PathSolver
from continuation.status import Kind

SEEN = 4.0
"""Two looks at round-off see the largest of many values within this factor."""

DIP = 0.25
"""A switch that comes down to less than this part of what it is on both sides may have two zeros there: the segment
says so to a few thousandths of its length, and the path is asked."""

TIED = 16.0
"""Two looks at round-off from two places differ by less than this: what is zero at the beginning of an arc was so
at the end of the one before, and switches so near to zero in one place vanish together."""

NEAR_ZERO = 1e-6
"""Of a switch's largest value on an arc: an end nearer to zero is looked at more closely."""

HALVINGS = 40
"""How near to a kink a switch that vanished there is looked for on its right side, in halves of a sixteenth."""

TOUCHING = 1e-9
"""Of a switch's largest value on the way to a limit of the path: so far beyond zero it may be at that limit, which is
known to a root of round-off."""

ZERO_ITERATIONS = 8
"""Iterations that bring a zero from four digits to round-off, and two that see that no more is to be had."""

ZEROS_ON_ARC = 50
"""Zeros located on one arc, each before the one found last; more than that are not between two points of a path."""


@frozen
class _Switch:
    """One switch as an event: positive on the piece."""

    pieces: Pieces
    index: int
    sign: int
    noise: float
    name: str = "switch"
    kind: Kind = Kind.KINK
    terminal: int = 0
    direction: int = 0

    def monitor(self, u: Array, v: Array) -> float:
        """The switch times its sign."""
        return self.sign * float(self.pieces.values(u)[self.index])

    def seen(self, point: Linearization) -> float:
        """The same at a point of the path, 0 where it is round-off."""
        g = self.monitor(point.u, point.tangent)
        return g if abs(g) > self.noise else 0.0


@frozen(eq=False)
class _Watched:
    """All switches, the signs of the piece, and what is round-off of each."""

    pieces: Pieces
    signs: Array
    noise: Array

    def switch(self, j: int) -> _Switch:
        """One of them."""
        return _Switch(self.pieces, j, int(self.signs[j]), float(self.noise[j]))

    def crossed(self, point: Linearization) -> list[int]:
        """Those that have the wrong sign at a point."""
        return np.flatnonzero(self.signs * self.pieces.values(point.u) < -self.noise).tolist()


def switch_noise(solver: PathSolver, pieces: Pieces, point: Linearization) -> Array:
    """What round-off in a point of the path makes of the switches there, shape (m,).

    The terms of each equation are known to their last places; what the path makes of that is seen with general signs.
    """
    evaluator, generic = solver.evaluator, generic_vector(point.u.size)
    terms = evaluator.round_off(point.u, evaluator.residual(point.u))
    signs = np.sign(generic)
    noise = np.maximum(*(np.abs(point.solve(terms * some[:-1])) for some in (signs, signs[::-1])))
    noise += solver.noise_by_component(point)
    here = pieces.values(point.u)
    looks = [np.abs(pieces.values(point.u + noise * move) - here) for move in (signs, signs[::-1])]
    return SEEN * np.maximum(*looks) + np.spacing(np.abs(here))


def first_zero(
    solver: PathSolver, pieces: Pieces, signs: Signs, arc: Arc
) -> tuple[Linearization, tuple[int, ...]] | None:
    """The first point of an arc at which a switch vanishes, and all switches that do there; None where none does.

    A switch that vanishes at the beginning was found there, and is asked again once it has left zero.

    `signs`: Of the piece on which the arc lies. Raises `EvaluationError` where the path cannot be evaluated, or is not
    settled by so many zeros.
    """
    s = np.array(signs)
    try:
        places = np.linspace(0.0, 1.0, MONITOR_PLACES)
        inner = [pieces.values(arc.segment.at(float(t))) for t in places[1:-1]]
        grid = s * np.array([pieces.values(arc.a.u), *inner, pieces.values(arc.b.u)])
        near = np.abs(grid[[0, -1]]) <= NEAR_ZERO * np.abs(grid).max(axis=0)
        if not (_suspects(grid) | near[1]).any():
            return None
        # Points of a path are as good as the tolerance. On which side of a switch they are that vanishes next to them
        # is a matter of round-off.
        a, b = (_on_path(solver, arc, t) if close.any() else p for t, p, close in zip((0.0, 1.0), (arc.a, arc.b), near))
        if a is not arc.a or b is not arc.b:
            arc = part_between(arc, a, b)
            grid[[0, -1]] = s * pieces.values(a.u), s * pieces.values(b.u)
        # Round-off about zero is no crossing: such a switch has not left it.
        fine = switch_noise(solver, pieces, arc.a)
        noise = TIED * fine
        fresh = grid[0] > fine
        grid = np.where(np.abs(grid) <= noise, 0.0, grid)
        grid[0, fresh] = np.maximum(grid[0, fresh], fine[fresh])
        suspects = np.flatnonzero(_suspects(grid) & (grid != 0.0).any(axis=0))
        found = _first(solver, _Watched(pieces, s, noise), arc, grid, suspects)
    except SwitchError as error:
        raise EvaluationError(str(error)) from error
    if found is None:
        return None
    point, j = found
    zero = np.abs(pieces.values(point.u)) <= TIED * switch_noise(solver, pieces, point)
    zero[j] = True
    return point, tuple(np.flatnonzero(zero).tolist())


def same_piece(pieces: Pieces, signs: Signs, point: Linearization, u: Array) -> bool:
    """Whether the way from a point of the path straight to another place stays on the point's piece."""
    try:
        way = np.linspace(0.0, 1.0, MONITOR_PLACES)
        values = np.array([np.array(signs) * pieces.values(point.u + t * (u - point.u)) for t in way])
    except SwitchError:
        return False
    return not _suspects(np.where(np.abs(values) <= TOUCHING * np.abs(values).max(axis=0), 0.0, values)[:-1]).any()


def _suspects(grid: Array) -> NDArray[np.bool_]:
    """Switches that may vanish behind the beginning: a sign on the grid, or a dip between its places."""
    wrong = (grid[1:] < 0.0).any(axis=0) | (grid[-1] <= 0.0)
    left, middle, right = grid[:-2], grid[1:-1], grid[2:]
    bend = left - 2.0 * middle + right
    lowest = middle - np.where(bend > 0.0, (right - left) ** 2 / np.where(bend > 0.0, 8.0 * bend, 1.0), 0.0)
    before = np.maximum.accumulate(grid, axis=0)[:-2]
    after = np.maximum.accumulate(grid[::-1], axis=0)[::-1][2:]
    dips = (bend > 0.0) & (middle <= left) & (middle <= right) & (lowest < DIP * np.minimum(before, after))
    return np.asarray(wrong | dips.any(axis=0))


def _first(
    solver: PathSolver, watched: _Watched, arc: Arc, grid: Array, suspects: NDArray[np.int64]
) -> tuple[Linearization, int] | None:
    """The first zero of the suspects: where the segment has the earliest, then whatever lies before that."""
    found: tuple[Linearization, int] | None = None
    whole, end = position(arc, arc.b.u), np.inf
    for j in sorted(suspects.tolist(), key=lambda j: _estimate(grid[:, j])):
        # A switch that has changed its sign before is seen at the zero found; one that only dips is not.
        if _estimate(grid[:, j]) > end + (0.0 if _change(grid[:, j]) else 1.0 / (MONITOR_PLACES - 1)):
            continue
        point = _zero(solver, watched.switch(j), arc, grid[:, j])
        if point is not None and (found is None or position(arc, point.u) < position(arc, found[0].u)):
            found, end = (point, j), position(arc, point.u) / whole
    for _ in range(ZEROS_ON_ARC):
        if found is None:
            return None
        point = found[0]
        crossed = [j for j in watched.crossed(point) if j != found[1]]
        if not crossed:
            return found
        part, first = part_between(arc, arc.a, point), watched.switch(crossed[0])
        places = np.linspace(0.0, 1.0, MONITOR_PLACES)[1:-1]
        inner = [first.monitor(part.segment.at(float(t)), point.tangent) for t in places]
        values = np.array([grid[0, first.index], *inner, first.seen(point)])
        earlier = _zero(solver, first, part, np.where(np.abs(values) <= first.noise, 0.0, values))
        if earlier is None:
            raise EvaluationError("a switch has changed its sign on the arc, and its zero is not found")
        found = earlier, first.index
    raise EvaluationError("switches vanish without end on the arc")


def _change(values: Array) -> tuple[int, int] | None:
    """The last place of the right sign before the first of the wrong one, and that; -1 where none is right before."""
    wrong = np.flatnonzero(values[1:] < 0.0)
    k = int(wrong[0]) + 1 if wrong.size else len(values) - 1
    if values[k] > 0.0:
        return None
    right = np.flatnonzero(values[:k] > 0.0)
    return (int(right[-1]) if right.size else -1), k


def _estimate(values: Array) -> float:
    """Where on the segment the switch first comes to zero, or to its deepest dip."""
    change = _change(values)
    if change is None:
        return (int(np.argmin(values[1:-1])) + 1) / (len(values) - 1)
    left, right = change
    if left < 0:
        return 0.0
    a, b = values[left], values[right]
    return float((left + (right - left) * a / (a - b)) / (len(values) - 1))


def _zero(solver: PathSolver, switch: _Switch, arc: Arc, values: Array) -> Linearization | None:
    """The first zero of one switch behind the beginning; None where the path says that there is none.

    The values are those of the segment; where the path disagrees, points of the path take their place.
    """
    places = np.linspace(0.0, 1.0, len(values))
    known = {0: arc.a, len(values) - 1: arc.b}

    def at(k: int) -> Linearization:
        if k not in known:
            known[k] = _on_path(solver, arc, float(places[k]))
        return known[k]

    change = _change(values)
    if change is not None:
        left, right = change
        quick = _by_newton(solver, switch, arc, float(places[left]), float(places[right])) if left >= 0 else None
        if quick is not None:
            return quick
        if left >= 0 and (switch.seen(at(left)) <= 0.0 or switch.seen(at(right)) > 0.0):
            values = np.array([values[0], *(switch.seen(at(k)) for k in range(1, len(values)))])
            change = _change(values)
            if change is None:
                return None
            left, right = change
        if left < 0:
            # It has vanished since the beginning, and goes to the wrong side: from there, or having been on the right.
            return at(right - 1) if right > 1 else _left_at_once(solver, switch, arc, float(places[1]))
        return _between(solver, switch, arc, at(left), at(right))
    start = int(np.argmax(values > 0.0))
    part = part_between(arc, at(start), arc.b)
    if switch.seen(part.a) <= 0.0:
        return None
    knots = [part.a, *(p for p, _ in _descent(solver, switch, part, *map(switch.seen, (part.a, part.b)))), part.b]
    for p, q in pairwise(knots):
        if switch.seen(p) > 0.0 > switch.seen(q):
            return _between(solver, switch, arc, p, q)
    return None


def _between(solver: PathSolver, switch: _Switch, arc: Arc, a: Linearization, b: Linearization) -> Linearization:
    ga, gb = switch.monitor(a.u, a.tangent), switch.monitor(b.u, b.tangent)
    if gb >= 0.0:
        return b
    part = part_between(arc, a, b)
    point = _root(solver, switch, part, None, ga, gb)
    if point is None:
        raise EvaluationError(f"switch {switch.index} jumps from one sign to the other")
    return point


def _by_newton(solver: PathSolver, switch: _Switch, arc: Arc, low: float, high: float) -> Linearization | None:
    """The zero by Newton's method along the path, from the segment's, with one factorisation made there.

    None where it does not come to round-off between the places: then bracketing will, with many more points.
    """
    evaluator, segment = solver.evaluator, arc.segment

    def g(t: float) -> float:
        return switch.monitor(segment.at(t), arc.a.tangent)

    scale = max(ga := g(low), -(gb := g(high)))
    if not ga > 0.0 > gb:
        return None
    t = zero_between(g, low, high, xtol=1e-15, rtol=1e-14, disp=False)
    if t is None:
        return None
    u, _ = solver.project(arc.a if t < 0.5 else arc.b, segment.at(t), arc.border)
    near = linearize(evaluator, u, arc.a.weights, arc.border)
    value = switch.monitor(u, near.tangent)
    whole, wide = position(arc, arc.b.u), high - low
    for _ in range(ZERO_ITERATIONS):
        slope = switch.sign * float(switch.pieces.along(u, near.tangent)[switch.index])
        if abs(value) <= AT_ROUND_OFF * scale or slope >= 0.0:
            break
        ahead, _ = solver.project(near, u - (value / slope) * near.tangent, arc.border)
        there = switch.monitor(ahead, near.tangent)
        if not abs(there) < abs(value):
            break
        u, value = ahead, there
    t = position(arc, u) / whole
    inside = max(low - wide, 0.0) < t < min(high + wide, 1.0)
    if not inside or abs(value) > min(switch.noise, NEARLY_ZERO * scale):
        return None
    return relinearize(evaluator, u, near.weights, near.anchor, arc.border)


def _left_at_once(solver: PathSolver, switch: _Switch, arc: Arc, t: float) -> Linearization:
    """The zero of a switch that begins at zero, and is back there so soon that no place of the grid saw it."""
    before = _on_path(solver, arc, t)
    for _ in range(HALVINGS):
        t *= 0.5
        point = _on_path(solver, arc, t)
        if switch.seen(point) > 0.0:
            return _between(solver, switch, arc, point, before)
        if switch.seen(point) == 0.0:
            break
        before = point
    raise EvaluationError("a switch that vanishes at the beginning of the arc takes the wrong sign behind it")


def _on_path(solver: PathSolver, arc: Arc, t: float) -> Linearization:
    return solver.project_and_linearize(arc.a if t < 0.5 else arc.b, arc.segment.at(t), arc.border)


def part_between(arc: Arc, a: Linearization, b: Linearization) -> Arc:
    """The part of an arc between two points of it."""
    return cubic_between(a, b, arc.border)
