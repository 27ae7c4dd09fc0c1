"""Paths of several homotopies in one archive."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.path import LocatedEvent, Path, Step
from continuation.step.tracer import Observer, Tracer
from problems.lcp.data.problem import MixedLCP

P = TypeVar("P", Step, LocatedEvent)


@frozen(eq=False)
class Padded:
    """An observer that pads paths with NaN to `unknowns`, as archives need."""

    observer: Observer
    unknowns: int

    @classmethod
    def of(cls, observer: Observer, problem: MixedLCP) -> Padded:
        """Pad to the KKT path's unknowns."""
        return cls(observer, (3 if problem.standard else 6) * problem.n)

    def step(self, tracer: Tracer, step: Step) -> None:
        """Pass on the step; the observer sees padded events."""
        path = tracer.path
        events, path.events = path.events, [self._padded(event) for event in path.events]
        try:
            self.observer.step(tracer, self._padded(step))
        finally:
            path.events = events

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """Pass on the event."""
        self.observer.event(tracer, self._padded(event))

    def end(self, tracer: Tracer) -> None:
        """Pass on the end."""
        self.observer.end(tracer)

    def _padded(self, point: P) -> P:
        return evolve(point, u=self._filled(point.u), tangent=self._filled(point.tangent))

    def _filled(self, u: Array) -> Array:
        if u.size - 1 == self.unknowns:
            return u
        filled = np.full(self.unknowns + 1, np.nan)
        filled[: u.size - 1], filled[-1] = u[:-1], u[-1]
        return filled


def show(path: Path, homotopy: Any, observer: Observer) -> None:
    """Show an observer a finished path."""
    tracer = Tracer(homotopy)
    tracer.path, tracer.counts = Path(), path.counts
    events = {event.step: event for event in path.events}
    for step in path.steps:
        tracer.path.steps.append(step)
        tracer.path.events += [events[step.index]] if step.index in events else []
        observer.step(tracer, step)
    tracer.path = path
    observer.end(tracer)
