"""Paths of different numbers of unknowns in one archive, and paths that were traced elsewhere, or not at all."""

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
    """An observer that shows another one paths with more unknowns, NaN, since an archive holds one number of them.

    `unknowns`: As many as the longest path has.
    """

    observer: Observer
    unknowns: int

    @classmethod
    def of(cls, observer: Observer, problem: MixedLCP) -> Padded:
        """For the paths of a problem, of which those of the KKT homotopy have most unknowns."""
        return cls(observer, (3 if problem.standard else 6) * problem.n)

    def step(self, tracer: Tracer, step: Step) -> None:
        """The step, filled up."""
        self.observer.step(tracer, evolve(step, u=self._filled(step.u), tangent=self._filled(step.tangent)))

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """The event, filled up."""
        self.observer.event(tracer, evolve(event, u=self._filled(event.u), tangent=self._filled(event.tangent)))

    def end(self, tracer: Tracer) -> None:
        """The end, as it is."""
        self.observer.end(tracer)

    def _filled(self, u: Array) -> Array:
        if u.size - 1 == self.unknowns:
            return u
        filled = np.full(self.unknowns + 1, np.nan)
        filled[: u.size - 1], filled[-1] = u[:-1], u[-1]
        return filled


def show(path: Path, homotopy: Any, observer: Observer) -> None:
    """Show an observer the steps and the end of a path that it did not see while it was made.

    `homotopy`: Of the path.
    """
    tracer = Tracer(homotopy)
    # An archive takes a step's kink from the last events of a path that grows.
    tracer.path, tracer.counts = Path(), path.counts
    events = {event.step: event for event in path.events}
    for step in path.steps:
        tracer.path.steps.append(step)
        tracer.path.events += [events[step.index]] if step.index in events else []
        observer.step(tracer, step)
    tracer.path = path
    observer.end(tracer)
