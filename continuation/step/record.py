"""Records of steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.evaluation.evaluator import Evaluator
from continuation.homotopy import Watcher, offers
from continuation.metric import norm, share
from continuation.path import LocatedEvent, Step
from continuation.point.linearization import Linearization
from continuation.status import Kind
from continuation.step.capabilities import observe_of
from continuation.step.state import State

Observe = Callable[[Array, float], Mapping[str, float]]


def observing(homotopy: Any, events: Sequence[Any]) -> Observe | None:
    """The function that computes a point's stored scalars, of homotopy and events; ValueError if two have one name."""
    own = observe_of(homotopy)
    others = [event.observe for event in events if offers(event, Watcher)]
    if not others:
        return own

    def observe(y: Array, lam: float) -> Mapping[str, float]:
        u = np.append(y, lam)
        found: dict[str, float] = {} if own is None else dict(own(y, lam))
        for other in others:
            more = other(u)
            if shared := found.keys() & more.keys():
                raise ValueError(f"observe: expected each name once, found {min(shared)!r} of an event too")
            found |= more
        return found

    return observe


@frozen(eq=False)
class StepRecorder:
    """Makes `Step` records, with `observe`'s scalars."""

    evaluator: Evaluator
    observe: Observe | None

    def record(
        self,
        point: Linearization,
        index: int,
        arclength: float,
        kind: int,
        residual_norm: float = math.nan,
        tangent: Array | None = None,
        **how: Any,
    ) -> Step:
        """The record of a point.

        `residual_norm`: Computed if NaN. `tangent`: Default: the point's. `**how`: Other fields of `Step`.
        """
        return Step(
            index=index,
            u=point.u,
            tangent=point.tangent if tangent is None else tangent,
            arclength=arclength,
            residual_norm=self.evaluator.residual_norm(point.u) if math.isnan(residual_norm) else residual_norm,
            orientation=point.orientation,
            kind=kind,
            share=share(point.weights, point.tangent),
            observed={} if self.observe is None else self.observe(point.y, point.lam),
            **how,
        )

    def observing(self, events: Sequence[LocatedEvent]) -> Sequence[LocatedEvent]:
        """Events with extra scalars."""
        if self.observe is None:
            return events
        return [evolve(event, observed=self.observe(event.y, event.lam)) for event in events]

    def end(self, point: Linearization, state: State, u: Array) -> Step:
        """Record of an end that no step reached."""
        chord = u - point.u
        length = norm(point.weights, chord)
        end = evolve(point, u=u, tangent=chord / length if length > 0.0 else point.tangent)
        return self.record(end, state.index + 1, state.here.arclength + length, Kind.TARGET, step_length=length)
