"""Paths of several homotopies in one archive."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.path import LocatedEvent, Path, Step
from continuation.step.tracer import Observer, Tracer
from problems.lcp.data.problem import MixedLCP


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
        """Pass on the step."""
        self.observer.step(tracer, evolve(step, u=self._filled(step.u), tangent=self._filled(step.tangent)))

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """Pass on the event."""
        self.observer.event(tracer, evolve(event, u=self._filled(event.u), tangent=self._filled(event.tangent)))

    def end(self, tracer: Tracer) -> None:
        """Pass on the end."""
        self.observer.end(tracer)

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
