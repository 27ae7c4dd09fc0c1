"""Decide whether an arc counts, where the path ends on it, and its events."""

from __future__ import annotations

import numpy as np
from attrs import Factory, evolve, field, frozen

from continuation.arrays import dot
from continuation.ends.target import ArcEnd, EndsAt, Target
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.pieces import Pieces
from continuation.events import KinkPoint
from continuation.events.branch_point import BranchPoint
from continuation.events.scan import first_terminal, found_by_events, scan_events, up_to
from continuation.kinks.first import first_zero
from continuation.kinks.through import Crossing, cross
from continuation.metric import norm
from continuation.path import LocatedEvent
from continuation.point.arc import Arc, angle_between, arc_between, cut, length_between, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver, arc_on_path
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection
from continuation.status import Kind
from continuation.step.crossing import SMALLEST, Crossed, on_arc
from continuation.step.guard import objection
from continuation.step.settings import Settings
from continuation.step.state import State
from continuation.step.stepper import Arrival

MULTIPLE = {"kind": Kind.SINGULAR_POINT, "name": "multiple branch point"}


@frozen(eq=False)
class Accepted:
    """An accepted arc with its end and events."""

    ending: ArcEnd
    attempt: Arrival
    events: list[LocatedEvent]
    orientation: int
    monitors: tuple[float, ...]
    occurrences: tuple[int, ...]
    crossing: Crossing | None = None


@frozen(eq=False)
class Examiner:
    """Decides whether an arc counts."""

    solver: PathSolver
    settings: Settings
    target: Target
    pieces: Pieces | None = None
    branch_index: int | None = field(
        default=Factory(lambda examiner: examiner.settings.index_of(BranchPoint), takes_self=True), init=False
    )

    def examine(
        self, point: Linearization, state: State, attempt: Arrival, prediction: Prediction, landed: bool
    ) -> Accepted | Rejected:
        """Return the arc to the arrival, or why it is rejected.

        `prediction`: if a series, the path between the points. `landed`: whether the attempt aimed at the target.
        """
        arrival, events, orientation = attempt.point, self.settings.events, state.orientation
        arc = arc_between(point, arrival, prediction)
        branch: Crossed | None = None
        kink: tuple[Linearization, tuple[int, ...]] | None = None
        try:
            missed = _across(point, attempt, prediction) if landed else attempt.correction.distance
            if self.pieces is not None:
                kink = first_zero(self.solver, self.pieces, state.signs, arc)
            if kink is not None:
                arrival, landed = kink[0], False
                arc = cut(arc, arrival)
            looked_at = arc_on_path(self.solver, arc, missed)
            if looked_at is None:
                return _rejected(attempt, Rejection.MIDPOINT)
            arc = looked_at
            ending = self.target.ending_of_arc(arc, state, landed)
            index, flipped = self.branch_index, arrival.orientation not in (0, orientation)
            if ending.limit is not None:
                # A singular end loses rank by itself.
                flipped = False
            elif index is not None:
                ends = ending.at in (EndsAt.TARGET, EndsAt.START_PARAMETER)
                part = ending.arc if ends else arc
                changed = part.b.orientation not in (0, orientation)
                seen = on_arc(self.solver, part, attempt, prediction, changed, ends, state.index)
                if isinstance(seen, Rejected):
                    return seen
                branch = seen
            elif flipped:
                return _rejected(attempt, Rejection.ORIENTATION)
            if flipped:
                orientation = arrival.orientation
            if kink is not None:
                ending = self._ending_in_kink(ending, kink[0])
            at = branch.point if branch is not None and within(arc, branch.point, ending.arc.b) else None
            found, monitors, explained = self._events_on(arc, ending, state, at)
            several = ending.limit is not None or (branch is not None and branch.rays is None)
            # In shorter arcs poles of H_y or symmetry make eigenvalue count and events differ.
            if not (explained or several) and attempt.h > SMALLEST * state.h:
                return _rejected(attempt, Rejection.UNACCOUNTED)
        except EvaluationError as error:
            return _rejected(attempt, Rejection.ARC, str(error))
        crossing = None
        if kink is not None and ending.at is EndsAt.KINK and self.pieces is not None:
            crossing = cross(self.solver, self.pieces, state.signs, arrival, orientation, kink[1])
            found = [*found, (self.settings.index_of(KinkPoint) or 0, arrival)]
        last, occurred = first_terminal(events, state.occurrences, found)
        if last is not None:
            i, stopping = found[last]
            whole = ending.whole and (stopping.u == arrival.u).all()
            crossing = crossing if last == len(found) - 1 else None
            ending = ArcEnd(cut(ending.arc, stopping), EndsAt.EVENT, events[i].kind, bool(whole))
            found = found[: last + 1]
        for guard in self.settings.guards:
            if words := objection(guard, ending.arc):
                return _rejected(attempt, Rejection.GUARD, words)
        located = [self._located(i, event, point, state, ending.arc.b) for i, event in found]
        if branch is not None:
            known = {"rays": branch.rays} if branch.rays is not None else MULTIPLE
            located = [evolve(at, **known) if at.kind is Kind.BRANCH_POINT else at for at in located]
        if crossing is not None:
            located[-1] = evolve(located[-1], name=crossing.name, switches=crossing.switches, rays=crossing.rays)
        return Accepted(ending, attempt, located, orientation, monitors, occurred, crossing)

    def _events_on(
        self, arc: Arc, ending: ArcEnd, state: State, branch_point: Linearization | None
    ) -> tuple[list[tuple[int, Linearization]], tuple[float, ...], bool]:
        """Events up to the first terminal one, monitors at the end, and whether events explain the eigenvalues'
        changes.
        """
        solver, events, at, index = self.solver, self.settings.events, branch_point, self.branch_index

        def place(pair: tuple[int, Linearization]) -> float:
            return position(arc, pair[1].u)

        found, monitors = scan_events(solver, events, state.monitors, ending.arc, at)
        if index is not None and at is not None:
            found = sorted((*found, (index, at)), key=place)
        last, _ = first_terminal(events, state.occurrences, found)
        ended = ending.arc
        if last is not None:
            ended = cut(ending.arc, found[last][1])
            at = at if at is not None and within(arc, at, ended.b) else None
            found = up_to(solver, events, state.monitors, ended, found[: last + 1], at)
        more, explained = found_by_events(solver, events, ended, found)
        return sorted((*found, *more), key=place) if more else found, monitors, explained

    def _ending_in_kink(self, ending: ArcEnd, kink: Linearization) -> ArcEnd:
        if ending.at is not EndsAt.NOTHING:
            return ending
        target = self.settings.target
        if target is None or abs(kink.lam - target) > self.solver.noise_by_component(kink)[-1]:
            return ArcEnd(ending.arc, EndsAt.KINK, Kind.KINK, False)
        end = evolve(kink, u=np.append(kink.y, target))
        return ArcEnd(cut(ending.arc, end), EndsAt.TARGET, Kind.TARGET, False)

    def _located(
        self, i: int, at: Linearization, begin: Linearization, state: State, end: Linearization
    ) -> LocatedEvent:
        event = self.settings.events[i]
        return LocatedEvent(
            name=event.name,
            kind=event.kind,
            arclength=state.here.arclength + length_between(begin, at, angle_between(begin, at)),
            u=at.u,
            tangent=at.tangent,
            residual_norm=self.solver.evaluator.residual_norm(at.u),
            monitor=event.monitor(at.u, at.tangent),
            orientation=at.orientation,
            step=state.index + 1,
            ends_step=bool((at.u == end.u).all()),
            weights=begin.weights,
        )


def within(arc: Arc, at: Linearization, end: Linearization) -> bool:
    """Whether a point lies on the arc up to `end`."""
    return position(arc, at.u) <= position(arc, end.u)


def _across(point: Linearization, attempt: Arrival, prediction: Prediction) -> float:
    off = attempt.point.u - prediction(attempt.h)
    return norm(point.weights, off - point.tangent * dot(point.border, off))


def _rejected(attempt: Arrival, reason: Rejection, detail: str = "") -> Rejected:
    return Rejected(attempt.h, reason, detail, attempt.correction.contraction)
