"""What lies on an accepted arc: events in order, and whether the path ends on it."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array
from continuation.evaluation import EvaluationError, Evaluator
from continuation.events import Event, TargetValue, TurningPoint
from continuation.linearization import Linearization
from continuation.location import Arc, hidden, locate
from continuation.tolerance import Tolerance

ROUND_OFF = 1e-13
"""How near a fold must be to the target, relative to max(1, |target|), to lie on it."""


def cut(arc: Arc, end: Linearization) -> Arc:
    """The arc up to a point on it."""
    sigma = float(np.dot(arc.border, end.u - arc.a.u))
    return Arc(arc.a, end, arc.border, arc.segment.until(sigma, end.u, end.tangent, arc.border))


def crossing(evaluator: Evaluator, arc: Arc, value: float, tolerance: Tolerance) -> Linearization | None:
    """Where the arc first takes a parameter value that its ends enclose, or that it touches in a fold."""
    before, after = arc.a.lam - value, arc.b.lam - value
    if before * after < 0.0:
        points = locate(evaluator, TargetValue(value), arc, before, after, tolerance)
        return points[0] if points else None
    if before == 0.0 or arc.a.tangent[-1] * arc.b.tangent[-1] >= 0.0 or before * arc.a.tangent[-1] >= 0.0:
        return None
    # The parameter came nearer and turned away again: a fold on the target is an end, and so is what lies beyond it.
    nearest = min((arc.segment.at(t)[-1] - value) * np.sign(before) for t in np.linspace(0.0, 1.0, 9))
    if nearest > 0.5 * min(abs(before), abs(after)):
        return None
    fold = locate(evaluator, TurningPoint(), arc, float(arc.a.tangent[-1]), float(arc.b.tangent[-1]), tolerance)
    if not fold:
        return None
    gap = (fold[0].lam - value) * np.sign(before)
    # The fold is located to round-off, and so is its parameter value: a path that passes through the target on its
    # way to a fold just behind it ends on the target.
    scale = ROUND_OFF * max(1.0, abs(value))
    if abs(gap) <= scale:
        return fold[0]
    return crossing(evaluator, cut(arc, fold[0]), value, tolerance) if gap < 0.0 else None


def monitored(event: Event, point: Linearization) -> float:
    """The event's monitor at a point; an IndexError names the component that does not exist."""
    try:
        return event.monitor(point.u, point.tangent)
    except IndexError as error:
        raise IndexError(f"events: {event!r} asks for a component of u = (y, lam), which has {point.u.size}") from error


def occurrences(
    evaluator: Evaluator, events: tuple[Event, ...], before: tuple[float, ...], arc: Arc, tolerance: Tolerance
) -> tuple[list[tuple[int, Linearization]], tuple[float, ...]]:
    """All events on the arc, in order, and the monitors' values at its end.

    A zero exactly at the arc's beginning was found there before; the sign just behind it takes its place.
    """
    found: list[tuple[int, Linearization]] = []
    values = []
    for i, event in enumerate(events):
        g = event.monitor(arc.b.u, arc.b.tangent)
        values.append(g)
        first = before[i] if before[i] != 0.0 else event.monitor(*arc.behind)
        if first == 0.0 or not hidden(event, arc.samples, first, g):
            continue
        try:
            points = locate(evaluator, event, arc, first, g, tolerance)
        except EvaluationError:
            # The arc is on the path, its interior could not be evaluated: the crossing is reported at its end.
            points = [arc.b] if first * g < 0.0 and np.sign(g) * event.direction >= 0 else []
        found += [(i, point) for point in points]
    found.sort(key=lambda pair: position(arc, pair[1].u))
    return found, tuple(values)


def position(arc: Arc, u: Array) -> float:
    """Pseudo-arclength of a point on the arc, from its beginning."""
    return float(np.dot(arc.border, u - arc.a.u))


def stop(
    events: tuple[Event, ...], counted: tuple[int, ...], found: list[tuple[int, Linearization]]
) -> tuple[int | None, tuple[int, ...]]:
    """At which of the events found the path stops, if at any, and how often each has occurred up to there."""
    counts = list(counted)
    for k, (i, _) in enumerate(found):
        counts[i] += 1
        if events[i].terminal and counts[i] == events[i].terminal:
            return k, tuple(counts)
    return None, tuple(counts)
