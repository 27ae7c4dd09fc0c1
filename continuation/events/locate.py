"""Where on an accepted arc a monitor vanishes: a bracketing method of high order on corrected points."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

import numpy as np
from attrs import evolve
from scipy.optimize import minimize_scalar

from continuation.arrays import dot, largest
from continuation.contraction import HALVING
from continuation.evaluation.errors import EvaluationError
from continuation.events import Event, TargetValue, TurningPoint
from continuation.events.roots import zero_between
from continuation.point.arc import Arc, cubic_between
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.point.segment import CUBIC, HermiteSegment, QuinticSegment, Segment, hermite

JUMP = 1e-3
"""A bracket that has closed round more than this, relative to where it began, holds a jump and no zero."""

MONITOR_PLACES = 17
"""Places where a monitor is looked at before its lowest value is sought: a cubic has two turns at most."""

DESCENTS, INSIDE_ARC, AS_EXPECTED = 8, 1e-6, 0.1
"""At most so many points are put on the path to find a monitor's least value, so far inside of an arc; one at which it
is within a tenth of what was expected settles that there is no zero."""

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


def _lowest(event: Event, arc: Arc, sign: float) -> tuple[float, float]:
    """Where on the arc's segment the monitor comes nearest to changing its sign, and its value there times the sign."""
    along = _along(event, arc.guide, arc.length)

    def g(t: float) -> float:
        return sign * along(t)

    places = np.linspace(0.0, 1.0, MONITOR_PLACES)
    k = int(np.argmin([g(float(t)) for t in places]))
    around = float(places[max(k - 1, 0)]), float(places[min(k + 1, MONITOR_PLACES - 1)])
    least = minimize_scalar(g, bounds=around, method="bounded", options={"xatol": 1e-9})
    return float(least.x), float(least.fun)


def _descent(solver: PathSolver, event: Event, arc: Arc, ga: float, gb: float) -> list[tuple[Linearization, float]]:
    """Points of the path towards the least value of a monitor that has one sign at both ends, up to another sign.

    The segment says where; the point of the path there makes two segments out of one, which say it better, until the
    monitor changes its sign, or is what was expected and does not.
    """
    sign = float(np.sign(ga))
    knots, parts = [(arc.a, ga), (arc.b, gb)], [arc]
    for _ in range(DESCENTS):
        lowest = [_lowest(event, part, sign) for part in parts]
        k = min(range(len(parts)), key=lambda i: lowest[i][1])
        part, (t, expected) = parts[k], lowest[k]
        if not INSIDE_ARC < t < 1.0 - INSIDE_ARC:
            break
        point, g = _knot(solver, event, part, t)
        knots.insert(k + 1, (point, g))
        if sign * g <= 0.0 or abs(sign * g - expected) <= AS_EXPECTED * abs(g):
            break
        parts[k : k + 1] = [cubic_between(part.a, point, arc.border), cubic_between(point, part.b, arc.border)]
    return knots[1:-1]


def locate(solver: PathSolver, event: Event, arc: Arc, ga: float, gb: float) -> list[Linearization]:
    """All zeros of the monitor on the arc, in order, each on the path to round-off.

    Parameters
    ----------
    solver : PathSolver
    event : Event
    arc : Arc
    ga, gb : float
        The monitor at the ends; ga is not zero.
    """
    knots = [(arc.a, ga), (arc.b, gb)]
    along = [ga, *(event.monitor(u, v) for u, v in arc.samples), gb]
    changes = sum(p * q < 0.0 for p, q in itertools.pairwise(along))
    divided = ga * gb > 0.0 or changes > 1
    if ga * gb > 0.0 and changes <= 2:
        knots[1:1] = _descent(solver, event, arc, ga, gb)
    elif divided:
        knots[1:1] = [_knot(solver, event, arc, t) for t in _dividing(arc, along) if 0.0 < t < 1.0]
    found = []
    for (left, gl), (right, gr) in itertools.pairwise(knots):
        if gl == 0.0 or gl * gr > 0.0 or np.sign(gl) * event.direction > 0:
            continue
        if gr == 0.0:
            found.append(right)
        else:
            series = None if divided else arc.guide
            part = Arc(left, right, arc.border, arc.segment)
            root = _root(solver, event, part, series, gl, gr)
            found += [] if root is None else [root]
    return found


def _dividing(arc: Arc, along: list[float]) -> list[float]:
    """Where to evaluate the monitor on the path itself, so that each zero gets a bracket of its own.

    All samples of a cubic, which is a rough guide. Of the many samples of a series, which is a good one, those on
    either side of a sign change, and the lowest if there is none.
    """
    inside = arc.guide.inside
    if len(inside) <= CUBIC:
        return list(inside)
    wanted = {k for k, (p, q) in enumerate(itertools.pairwise(along)) if p * q < 0.0}
    wanted |= {k + 1 for k in wanted}
    wanted = wanted or {min(range(1, len(along) - 1), key=lambda k: abs(along[k]))}
    return [inside[k - 1] for k in sorted(wanted) if 0 < k < len(along) - 1]


def _knot(solver: PathSolver, event: Event, arc: Arc, t: float) -> tuple[Linearization, float]:
    segment = arc.guide
    point = solver.project_and_linearize(arc.a if t < 0.5 else arc.b, segment.at(t), arc.border, segment.derivative(t))
    return point, event.monitor(point.u, point.tangent)


def _guess(event: Event, segment: Segment, low: float = 0.0, high: float = 1.0) -> float | None:
    """The monitor's zero on a part of the segment; None where the values at its ends do not bracket one."""
    g = _along(event, segment)
    if g(low) * g(high) >= 0.0:
        return None
    # A guess: where the monitor is so flat that it takes longer, the last bracket will do.
    return zero_between(g, low, high, xtol=1e-15, rtol=1e-14, disp=False)


def _continued(
    event: Event, arc: Arc, replaced: tuple[Linearization, float], last: tuple[Linearization, float], room: float
) -> tuple[Segment, float] | None:
    """The interpolant of the last point and the one that it took the place of, and where its continuation has the zero.

    None where these two are farther from each other than the `room` in which the zero lies is wide.
    """
    (old, before), (point, g) = replaced, last
    way = dot(arc.border, point.u - old.u)
    if not 0.0 < abs(way) < room or g == before:
        return None
    segment, until = hermite(old.u, old.tangent, point.u, point.tangent, arc.border), 1.0 + min(room / abs(way), 1.0)
    narrow = abs(way) <= NARROW_BRACKET * arc.length
    t = 1.0 + g / (before - g) if narrow else _guess(event, segment, 1.0, until)
    return None if t is None or not 1.0 < t < until else (segment, t)


def _root(
    solver: PathSolver, event: Event, arc: Arc, series: Segment | None, ga: float, gb: float
) -> Linearization | None:
    """One zero: interpolate, correct, linearize, narrow; None where the monitor jumps instead, as a tangent may.

    The interpolant has the tangents of both ends, so each pass raises the error of the guess to about the fourth
    power of the bracket; where one end of that stays, as in the method of false position, the last two points give
    another one, which is continued. A pass of the first kind that does not halve the monitor is followed by a
    bisection, or is the last one if the monitor is at round-off.
    """
    a, b = (arc.a, ga), (arc.b, gb)
    last = best = min(a, b, key=lambda end: abs(end[1]))
    scale = max(abs(ga), abs(gb))
    width = first = arc.length
    bisect, stalled, noise, replaced = False, 0, None, last
    for _ in range(PASSES):
        fine = width <= NARROW_BRACKET * first
        ahead = None if bisect or fine else _continued(event, arc, replaced, last, width)
        near = last[0]
        if ahead is not None:
            segment, t = ahead
        else:
            ua, ub = a[0], b[0]
            segment = series if series is not None else hermite(ua.u, ua.tangent, ub.u, ub.tangent, arc.border)
            guess = 0.5 if bisect else a[1] / (a[1] - b[1]) if fine else _guess(event, segment)
            t = 0.5 if guess is None else min(max(guess, 1e-12), 1.0 - 1e-12)
            near = ua if t < 0.5 else ub
        series = None
        # The ends of a narrow bracket differ by round-off in part, and so does the interpolant's direction.
        along = near.tangent if fine else segment.derivative(t)
        point = solver.project_and_linearize(near, segment.at(t), arc.border, along)
        last = point, event.monitor(point.u, point.tangent)
        slow = abs(last[1]) > HALVING * abs(best[1])
        bisect, stalled = slow and ahead is None, stalled + 1 if slow else 0
        best = min(best, last, key=lambda place: abs(place[1]))
        if a[1] * last[1] > 0.0:
            replaced, a = a, last
        else:
            replaced, b = b, last
        width, least = dot(arc.border, b[0].u - a[0].u), abs(best[1])
        if least <= AT_ROUND_OFF * scale or (stalled >= 2 and least <= NEARLY_ZERO * scale):
            break
        if bisect or fine or least <= NEARLY_ZERO * scale:
            # As near as points are known: farther bisections would locate round-off.
            noise = solver.noise(arc.a) if noise is None else noise
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
