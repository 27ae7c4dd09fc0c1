"""Where on an accepted arc a function of its points vanishes: one scanner for events, targets, faces and switches.

The arc's segment is a model of the function, and costs no evaluation of H. An arc has no zero where the model keeps the
sign that the function has at both ends, and comes down to no less than half of what it is there. It has one zero where
the ends have two signs and the model changes its sign once: that is bracketed on points of the path. Any other arc is
divided by a point of the path, where the model is lowest or has come through zero, and both parts are asked again.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from attrs import evolve, frozen
from scipy.optimize import minimize_scalar

from continuation.arrays import Array, dot, largest
from continuation.contraction import HALVING
from continuation.evaluation.errors import EvaluationError
from continuation.events import Event, TargetValue, TurningPoint
from continuation.events.roots import zero_between
from continuation.point.arc import Arc
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.point.segment import CUBIC, HermiteSegment, QuinticSegment, Segment, hermite

JUMP = 1e-3
"""A bracket that has closed round more than this, relative to where it began, holds a jump and no zero."""

MONITOR_PLACES = 17
"""Places where a monitor is looked at before its lowest value is sought: a cubic has two turns at most."""

DIVISIONS, INSIDE_ARC, AS_EXPECTED = 8, 1e-6, 0.1
"""An arc is divided so often in a row at most, so far inside of it; a point at which the function is within a tenth of
the least value that was expected settles that there is no zero."""

PASSES = 60
"""A bisection in every other pass narrows a bracket to round-off in these."""

NARROW_BRACKET = 1e-6
"""A bracket so narrow, relative to the first, that the difference of its ends is mostly round-off: a poor cubic."""

AT_ROUND_OFF, NEARLY_ZERO = 1e-15, 1e-10
"""The monitor's value, relative to those at the ends, that is zero; and that does where it
has not halved twice."""

TRANSVERSAL = 1e-6
"""The least component of a tangent, relative to its largest, along which a point is put on a value exactly."""


def may_vanish(event: Event, arc: Arc, ga: float, gb: float) -> bool:
    """Whether the monitor may vanish on an arc, judged by its ends and its least value inside.

    Ends of one sign may hide a pair of zeros where it has the other sign there, or dips to less than half of both.

    Parameters
    ----------
    event : Event
    arc : Arc
    ga, gb : float
        The monitor at the ends.
    """
    if gb == 0.0 or ga * gb < 0.0:
        return True
    sign, inside = math.copysign(1.0, ga), arc.guide.inside
    along = _of_coordinate(event, arc.guide, arc.length)
    found = [event.monitor(u, v) for u, v in arc.samples] if along is None else map(along, inside)
    values = [sign * ga, *[sign * g for g in found], sign * gb]
    return _least((0.0, *inside, 1.0), values) < 0.5 * min(abs(ga), abs(gb))


def _of_coordinate(event: Event, segment: Segment, length: float) -> Callable[[float], float] | None:
    """The monitor along a cubic of that length, as a function of t, where it looks at one coordinate; else None."""
    if not (isinstance(segment, HermiteSegment | QuinticSegment) and isinstance(event, TurningPoint | TargetValue)):
        return None
    at, slope = segment.coordinate(event.component)
    if isinstance(event, TurningPoint):
        return lambda t: slope(t) / length
    return lambda t: at(t) - event.value


def _along(event: Event, segment: Segment, length: float = 1.0) -> Callable[[float], float]:
    """The monitor along a segment of that length, as a function of t."""
    own = _of_coordinate(event, segment, length)
    return own or (lambda t: event.monitor(segment.at(t), segment.derivative(t) / length))


def _least(places: Sequence[float], values: Sequence[float]) -> float:
    """The least of some values and of the parabolas through each three neighbours between them.

    For the parameter's component of a cubic's tangent that is the least of all.
    """
    least = min(values)
    slopes = [(b - a) / (q - p) for p, q, a, b in zip(places, places[1:], values, values[1:])]
    for p, q, r, a, left, right in zip(places, places[1:], places[2:], values, slopes, slopes[1:]):
        bend = (right - left) / (r - p)
        if bend > 0.0:
            lowest = 0.5 * (p + q - left / bend)
            if p < lowest < r:
                least = min(least, a + (lowest - p) * (left + bend * (lowest - q)))
    return least


@frozen(eq=False)
class _Part:
    """A part of an arc between two points of the path, the function there, and its model from `low` to `high`."""

    a: Linearization
    b: Linearization
    ga: float
    gb: float
    model: Segment
    low: float = 0.0
    high: float = 1.0
    depth: int = 0

    def divided(self, point: Linearization, g: float, t: float, border: Array) -> tuple[_Part, _Part]:
        """The two parts on either side of a point. A series stays their model, a cubic gives way to two."""
        parts = []
        for a, b, ga, gb, low, high in (
            (self.a, point, self.ga, g, self.low, t),
            (point, self.b, g, self.gb, t, self.high),
        ):
            series = len(self.model.inside) > CUBIC
            model = (self.model, low, high) if series else (hermite(a.u, a.tangent, b.u, b.tangent, border), 0.0, 1.0)
            parts.append(_Part(a, b, ga, gb, *model, depth=self.depth + 1))
        return parts[0], parts[1]


def _undecided(event: Event, part: _Part, length: float) -> tuple[float, float] | None:
    """Where to divide a part, and which value is expected there; None if its ends say what is on it."""
    along = _along(event, part.model, length)
    sign = math.copysign(1.0, part.ga)
    inner = [t for t in part.model.inside if part.low < t < part.high]
    if len(part.model.inside) <= CUBIC:
        inner = np.linspace(part.low, part.high, MONITOR_PLACES)[1:-1].tolist()
    places = [part.low, *inner, part.high]
    values = [sign * part.ga, *(sign * along(t) for t in inner), sign * part.gb]
    turns = [k for k, (p, q) in enumerate(itertools.pairwise(values)) if p > 0.0 > q or p < 0.0 < q]
    if part.gb * part.ga <= 0.0:
        if len(turns) <= (part.gb != 0.0):
            return None
        m = max(len(turns) // 2 - 1, 0)
        between = range(turns[m] + 1, turns[m + 1] + 1 if m + 1 < len(turns) else len(values) - 1)
        k = max(between, key=lambda k: abs(values[k]), default=turns[m])
        return places[k], sign * values[k]
    if not turns and _least(places, values) >= 0.5 * min(abs(part.ga), abs(part.gb)):
        return None
    k = min(range(len(values)), key=values.__getitem__)
    around = places[max(k - 1, 0)], places[min(k + 1, len(places) - 1)]
    least = minimize_scalar(lambda t: sign * along(t), bounds=around, method="bounded", options={"xatol": 1e-9})
    return float(least.x), sign * float(least.fun)


def zeros(
    solver: PathSolver, event: Event, arc: Arc, ga: float, gb: float, noise: float = 0.0
) -> Iterator[Linearization]:
    """The zeros of the monitor on the arc, in order, each on the path to round-off.

    Parameters
    ----------
    solver : PathSolver
    event : Event
    arc : Arc
    ga, gb : float
        The monitor at the ends; ga is not zero.
    noise : float
        Values inside of the arc up to this are round-off, and change no sign.
    """
    parts = [_Part(arc.a, arc.b, ga, gb, arc.guide)]
    while parts:
        part = parts.pop()
        if part.ga == 0.0:
            continue
        where = _undecided(event, part, arc.length) if part.depth < DIVISIONS else None
        if where is not None and INSIDE_ARC < (where[0] - part.low) / (part.high - part.low) < 1.0 - INSIDE_ARC:
            t, expected = where
            near = part.a if t - part.low < part.high - t else part.b
            point = solver.project_and_linearize(near, part.model.at(t), arc.border, part.model.derivative(t))
            g = event.monitor(point.u, point.tangent)
            if abs(g) <= noise:
                g = math.copysign(noise, part.ga)
            if not min(part.ga * part.gb, part.ga * g) > 0.0 or abs(g - expected) > AS_EXPECTED * abs(g):
                parts += part.divided(point, g, t, arc.border)[::-1]
        elif part.ga * part.gb <= 0.0 and np.sign(part.ga) * event.direction <= 0:
            found = part.b if part.gb == 0.0 else _root(solver, event, arc.border, part)
            if found is not None:
                yield found


def _guess(event: Event, segment: Segment, low: float, high: float) -> float | None:
    """The monitor's zero on a part of the segment; None where the values at its ends do not bracket one."""
    g = _along(event, segment)
    if g(low) * g(high) >= 0.0:
        return None
    # A guess: where the monitor is so flat that it takes longer, the last bracket will do.
    return zero_between(g, low, high, xtol=1e-15, rtol=1e-14, disp=False)


def _continued(
    event: Event,
    border: Array,
    first: float,
    replaced: tuple[Linearization, float],
    last: tuple[Linearization, float],
    room: float,
) -> tuple[Segment, float] | None:
    """The interpolant of the last point and the one that it took the place of, and where its continuation has the zero.

    None where these two are farther from each other than the `room` in which the zero lies is wide.
    """
    (old, before), (point, g) = replaced, last
    way = dot(border, point.u - old.u)
    if not 0.0 < abs(way) < room or g == before:
        return None
    segment, until = hermite(old.u, old.tangent, point.u, point.tangent, border), 1.0 + min(room / abs(way), 1.0)
    narrow = abs(way) <= NARROW_BRACKET * first
    t = 1.0 + g / (before - g) if narrow else _guess(event, segment, 1.0, until)
    return None if t is None or not 1.0 < t < until else (segment, t)


def _root(solver: PathSolver, event: Event, border: Array, part: _Part) -> Linearization | None:
    """One zero: interpolate, correct, linearize, narrow; None where the monitor jumps instead, as a tangent may.

    The interpolant has the tangents of both ends, so each pass raises the error of the guess to about the fourth
    power of the bracket; where one end of that stays, as in the method of false position, the last two points give
    another one, which is continued. A pass of the first kind that does not halve the monitor is followed by a
    bisection, or is the last one if the monitor is at round-off.
    """
    a, b = (part.a, part.ga), (part.b, part.gb)
    last = best = min(a, b, key=lambda end: abs(end[1]))
    scale = max(abs(part.ga), abs(part.gb))
    width = first = dot(border, part.b.u - part.a.u)
    known: tuple[Segment, float, float] | None = (part.model, part.low, part.high)
    bisect, stalled, noise, replaced = False, 0, None, last
    for _ in range(PASSES):
        fine = width <= NARROW_BRACKET * first
        ahead = None if bisect or fine else _continued(event, border, first, replaced, last, width)
        near = last[0]
        if ahead is not None:
            segment, t = ahead
        else:
            ua, ub = a[0], b[0]
            segment, low, high = known or (hermite(ua.u, ua.tangent, ub.u, ub.tangent, border), 0.0, 1.0)
            guess = None if bisect else a[1] / (a[1] - b[1]) if fine else _guess(event, segment, low, high)
            t = low + 0.5 * (high - low) if guess is None else min(max(guess, low + 1e-12), high - 1e-12)
            near = ua if t - low < high - t else ub
        known = None
        # The ends of a narrow bracket differ by round-off in part, and so does the interpolant's direction.
        along = near.tangent if fine else segment.derivative(t)
        point = solver.project_and_linearize(near, segment.at(t), border, along)
        last = point, event.monitor(point.u, point.tangent)
        slow = abs(last[1]) > HALVING * abs(best[1])
        bisect, stalled = slow and ahead is None, stalled + 1 if slow else 0
        best = min(best, last, key=lambda place: abs(place[1]))
        if a[1] * last[1] > 0.0:
            replaced, a = a, last
        else:
            replaced, b = b, last
        width, least = dot(border, b[0].u - a[0].u), abs(best[1])
        if least <= AT_ROUND_OFF * scale or (stalled >= 2 and least <= NEARLY_ZERO * scale):
            break
        if bisect or fine or least <= NEARLY_ZERO * scale:
            # As near as points are known: farther bisections would locate round-off.
            noise = solver.noise(part.a) if noise is None else noise
            if width <= noise or least <= noise * abs(b[1] - a[1]) / width:
                break
    if abs(best[1]) > JUMP * scale and not (noise is not None and width <= noise):
        return None
    return _on_value(solver, event, best[0])


def _on_value(solver: PathSolver, event: Event, point: Linearization) -> Linearization:
    """For a wanted value of a component: put the component on it exactly, if the path is transversal to it there."""
    if not isinstance(event, TargetValue):
        return point
    unit = np.zeros_like(point.u)
    unit[event.component] = 1.0
    if abs(point.tangent[event.component]) <= TRANSVERSAL * largest(point.tangent):
        return point
    guess = point.u.copy()
    guess[event.component] = event.value
    try:
        u, _ = solver.project(point, guess, unit)
    except EvaluationError:
        return point
    u[event.component] = event.value
    return evolve(point, u=u)
