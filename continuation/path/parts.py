"""Steps and events of parts of paths."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import SIX_DIGITS, Array
from continuation.path.steps import LocatedEvent, Step
from continuation.point.segment import Segment, hermite
from continuation.status import Kind

StepsAndEvents: TypeAlias = tuple[list[Step], list[LocatedEvent]]


@frozen(eq=False)
class Backwards:
    """A segment, reversed."""

    forwards: Segment

    @property
    def inside(self) -> tuple[float, ...]:
        """Interior nodes."""
        return tuple(1.0 - t for t in reversed(self.forwards.inside))

    def at(self, t: float) -> Array:
        """The point at t."""
        return self.forwards.at(1.0 - t)

    def derivative(self, t: float) -> Array:
        """Its derivative."""
        return -self.forwards.derivative(1.0 - t)


def part_of(steps: Sequence[Step], events: Sequence[LocatedEvent], chosen: slice) -> StepsAndEvents:
    """Some steps and the events between; `ValueError` for a negative step."""
    numbers = range(*chosen.indices(len(steps)))
    if numbers.step < 0:
        raise ValueError("step: expected a positive one; path.reversed() turns a path round")
    part = [evolve(steps[i], index=k) for k, i in enumerate(numbers)]
    if numbers.step > 1:
        part = part[:1] + [evolve(b, segment=_cubic(a, b), weights=None) for a, b in pairwise(part)]
    inside = [event for event in events if numbers and numbers[0] < event.step <= numbers[-1]]
    after = [int(np.searchsorted(numbers, event.step)) for event in inside]
    ends = [event.ends_step and event.step in numbers for event in inside]
    return part, [evolve(event, step=k, ends_step=end) for event, k, end in zip(inside, after, ends)]


def _cubic(a: Step, b: Step) -> Segment | None:
    known = np.isfinite(a.tangent).all() and np.isfinite(b.tangent).all() and bool(np.dot(a.tangent, b.u - a.u) > 0.0)
    return hermite(a.u, a.tangent, b.u, b.tangent, a.tangent) if known else None


def turned_round(steps: Sequence[Step], events: Sequence[LocatedEvent]) -> StepsAndEvents:
    """The path from end to start."""
    old, last = list(steps), len(steps) - 1
    whole = old[-1].arclength if old else 0.0
    # At a kink, the tangent is the arriving arc's.
    kinks = {e.step: -e.rays[1] for e in events if e.kind == Kind.KINK and e.rays is not None and len(e.rays) > 1}
    turned = []
    for k, step in enumerate(reversed(old)):
        # An arc's fields are those of the step at its end.
        arc = old[last - k + 1] if k else None
        segment = None if arc is None or arc.segment is None else Backwards(arc.segment)
        kind = Kind.START if k == 0 else Kind.REGULAR if step.kind in (Kind.START, Kind.TARGET) else step.kind
        turned.append(
            evolve(
                step,
                index=k,
                tangent=kinks.get(step.index, -step.tangent),
                orientation=-step.orientation,
                arclength=whole - step.arclength,
                kind=kind,
                step_length=0.0 if arc is None else arc.step_length,
                segment=segment,
                weights=None if arc is None else arc.weights,
            )
        )
    met = [
        evolve(
            event,
            tangent=kinks[event.step] if event.kind == Kind.KINK and event.step in kinks else -event.tangent,
            rays=None if event.rays is None else event.rays[[1, 0, *range(2, len(event.rays))]],
            orientation=-event.orientation,
            arclength=whole - event.arclength,
            step=max(last - event.step + (not event.ends_step), 1),
            ends_step=event.ends_step and event.step < last,
        )
        for event in reversed(events)
    ]
    return turned, met


def following(
    first: Sequence[Step], second: Sequence[Step], events: Sequence[LocatedEvent], extent: float
) -> StepsAndEvents:
    """Steps and events of a second path, counted from the first's end; `ValueError` if the ends differ.

    `extent`: of the larger path.
    """
    a, b = first[-1], second[0]
    if a.u.shape != b.u.shape or not np.abs(a.u - b.u).max() <= SIX_DIGITS * max(extent, np.finfo(float).tiny):
        raise ValueError(f"other: expected a path that begins at lam = {a.lam:.6g}, found one from lam = {b.lam:.6g}")
    return shifted(evolve(a, index=len(first) - 1), second, events)


def shifted(a: Step, second: Sequence[Step], events: Sequence[LocatedEvent]) -> StepsAndEvents:
    """Steps and events of a path, counted from step `a`."""
    return (
        [evolve(s, index=s.index + a.index, arclength=a.arclength + s.arclength) for s in list(second)[1:]],
        [evolve(event, step=event.step + a.index, arclength=a.arclength + event.arclength) for event in events],
    )
