"""An arc that the controller accepts, examined before it counts: orientation, connectedness, end, events."""

from __future__ import annotations

import math

from attrs import evolve, frozen

from continuation.arrays import Array, largest
from continuation.ends.target import ArcEnd, Target
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.events.branch_point import locate_branch_point
from continuation.events.scan import first_terminal, scan_events
from continuation.path import LocatedEvent
from continuation.point.arc import Arc, angle_between, cut, length_between, position, segment_between
from continuation.point.linearization import Linearization
from continuation.point.projection import midpoint_on_path
from continuation.predictors import Prediction
from continuation.status import Kind, Status
from continuation.step.settings import Settings
from continuation.step.state import State
from continuation.step.stepper import Attempt


@frozen(eq=False)
class Accepted:
    """An accepted arc after examination: how it ends, the events on it, and what the state after it is made of."""

    ending: ArcEnd
    trial: Attempt
    rejections: int
    state: State
    events: list[LocatedEvent]
    monitors: tuple[float, ...]
    occurrences: tuple[int, ...]


def residual_norm(evaluator: Evaluator, u: Array) -> float:
    """The largest component of the residual; nan where there is none."""
    try:
        return largest(evaluator.residual(u))
    except EvaluationError:
        return math.nan


@frozen(eq=False)
class Examiner:
    """What an examination needs."""

    evaluator: Evaluator
    settings: Settings
    ends: Target

    def examine(
        self, point: Linearization, state: State, trial: Attempt, rejections: int, prediction: Prediction
    ) -> Accepted | None:
        """The arc from `point` to the trial's arrival; None if it does not hold."""
        arrival = trial.arrival
        assert arrival is not None
        evaluator, tolerance, events = self.evaluator, self.settings.tolerance, self.settings.events
        arc = Arc(point, arrival, point.border, segment_between(point, arrival, prediction))
        crossed: list[tuple[int, Linearization]] = []
        if arrival.orientation not in (0, state.orientation):
            index = self.settings.branch_index
            branch = None if index is None else locate_branch_point(evaluator, point, arrival, tolerance)
            if index is None or branch is None:
                return None
            crossed.append((index, branch))
            state = evolve(state, orientation=arrival.orientation)
        try:
            if not midpoint_on_path(evaluator, arc, tolerance):
                return None
            ending = (
                ArcEnd(arc, Kind.TARGET, Status.REACHED_TARGET) if trial.landed else self.ends.ending_of_arc(arc, state)
            )
            found, monitors = scan_events(evaluator, events, state.monitors, ending.arc, tolerance)
        except EvaluationError:
            return None
        if crossed and position(arc, crossed[0][1].u) <= position(arc, ending.arc.b.u):
            found = sorted((*found, *crossed), key=lambda pair: position(arc, pair[1].u))
        last, occurred = first_terminal(events, state.occurrences, found)
        if last is not None:
            i, stopping = found[last]
            ending = ArcEnd(cut(ending.arc, stopping), events[i].kind, Status.STOPPED_AT_EVENT)
            found = found[: last + 1]
        located = [self.located(i, event, point, state) for i, event in found]
        return Accepted(ending, trial, rejections, state, located, monitors, occurred)

    def located(self, i: int, at: Linearization, begin: Linearization, state: State) -> LocatedEvent:
        """The i-th event, found at a point of the arc that begins at another."""
        event = self.settings.events[i]
        return LocatedEvent(
            name=event.name,
            kind=event.kind,
            arclength=state.here.arclength + length_between(begin, at, angle_between(begin, at)),
            u=at.u,
            tangent=at.tangent,
            residual_norm=residual_norm(self.evaluator, at.u),
            monitor=event.monitor(at.u, at.tangent),
            orientation=at.orientation,
            step=state.index,
        )
