"""Events on an accepted arc, in order, and whether the path ends there."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import ROOT_OF_ROUND_OFF, Array
from continuation.evaluation.errors import EvaluationError
from continuation.events import Event, KinkPoint, TargetValue
from continuation.events.branch_point import BranchPoint
from continuation.events.locate import may_vanish, on_value, zeros
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver

SOUGHT_ELSEWHERE = (BranchPoint, KinkPoint)
"""Events that the tracer itself finds."""


def found_by_events(
    solver: PathSolver, events: tuple[Any, ...], arc: Arc, found: list[tuple[int, Linearization]]
) -> tuple[list[tuple[int, Linearization]], bool]:
    """Points that the `continuation.homotopy.Watcher`s among the events find, and whether these accept the arc.

    `found`: the other events' points, each with the event's index.
    """
    watching: list[tuple[int, Any]] = [(i, event) for i, event in enumerate(events) if hasattr(event, "found_on")]
    own = [(i, point) for i, event in watching for point in event.found_on(solver, arc)]
    known = [(events[i].kind, point) for i, point in (*found, *own)]
    return own, all(event.accounts_for(arc, known) for _, event in watching)


def monitored(event: Event, point: Linearization) -> float:
    """The monitor at a point; an IndexError names a missing component."""
    try:
        return event.monitor(point.u, point.tangent)
    except IndexError as error:
        raise IndexError(f"events: {event!r} asks for a component of u = (y, lam), which has {point.u.size}") from error


def _vanishes(event: Event, point: Linearization, first: float, last: float) -> bool:
    """Whether a monitor vanishes to half of the digits, which directions at a branch point have."""
    return abs(event.monitor(point.u, point.tangent)) <= ROOT_OF_ROUND_OFF * max(abs(first), abs(last))


def scan_events(
    solver: PathSolver,
    events: tuple[Event, ...],
    before: tuple[float, ...],
    arc: Arc,
    branch_point: Linearization | None = None,
) -> tuple[list[tuple[int, Linearization]], tuple[float, ...]]:
    """Events on the arc in order, without those of a `Watcher`, and end values of monitors.

    A zero at the beginning was counted before; the sign behind it replaces it. A zero at the `branch_point` on the arc
    is that point: corrections beside it lose digits.
    """
    found: list[tuple[int, Linearization]] = []
    values = []
    noise: Array | None = None
    for i, event in enumerate(events):
        if hasattr(event, "found_on"):
            values.append(0.0)
            continue
        if isinstance(event, SOUGHT_ELSEWHERE):
            values.append(before[i])
            continue
        g = event.monitor(arc.b.u, arc.b.tangent)
        values.append(g)
        first = before[i] if before[i] != 0.0 else event.monitor(*arc.just_after_start)
        if first == 0.0 or not may_vanish(event.monitor, arc, first, g):
            continue
        resolution = getattr(event, "resolution", None)
        if resolution is not None:
            if noise is None:
                of_tangents = solver.tangent_noise(arc.a) + solver.tangent_noise(arc.b)
                noise = solver.noise_by_component(arc.a) + arc.length * of_tangents
            # Round-off at both ends is no crossing.
            if max(abs(first), abs(g)) <= resolution(noise, arc.length):
                continue
        crosses = first * g < 0.0 and np.sign(g) * event.direction >= 0
        try:
            if branch_point is not None and _vanishes(event, branch_point, first, g):
                points = [branch_point] if crosses else []
            else:
                points = list(zeros(solver, event.monitor, arc, first, g, direction=event.direction))
        except EvaluationError:
            # The interior cannot be evaluated: the end stands for the crossing.
            points = [arc.b] if crosses else []
        if isinstance(event, TargetValue):
            points = [on_value(solver, point, event.component, event.value) for point in points]
        found += [(i, point) for point in points]
    found.sort(key=lambda pair: position(arc, pair[1].u))
    return found, tuple(values)


def first_terminal(
    events: tuple[Event, ...], counted: tuple[int, ...], found: list[tuple[int, Linearization]]
) -> tuple[int | None, tuple[int, ...]]:
    """Index in `found` of the event that stops the path, or None, and counts up to it."""
    counts = list(counted)
    for k, (i, _) in enumerate(found):
        counts[i] += 1
        if events[i].terminal and counts[i] == events[i].terminal:
            return k, tuple(counts)
    return None, tuple(counts)


def up_to(
    solver: PathSolver,
    events: tuple[Event, ...],
    before: tuple[float, ...],
    arc: Arc,
    found: list[tuple[int, Linearization]],
    branch_point: Linearization | None,
) -> list[tuple[int, Linearization]]:
    """Events up to the last of `found`, where the arc was cut: the new end may show more of them."""
    kept = found
    for i, event in enumerate(events):
        known = [pair for pair in found if pair[0] == i]
        if i == found[-1][0] or before[i] == 0.0:
            continue
        if (before[i] * event.monitor(arc.b.u, arc.b.tangent) < 0.0) != len(known) % 2:
            again = [(i, point) for _, point in scan_events(solver, (event,), (before[i],), arc, branch_point)[0]]
            if len(again) > len(known):
                kept = [*again, *(pair for pair in kept if pair[0] != i)]
    return kept if kept is found else sorted(kept, key=lambda pair: (position(arc, pair[1].u), pair is found[-1]))
