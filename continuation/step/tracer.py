"""The loop: an iterator of accepted steps. `continuation.trace` drives it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from attrs import evolve

from continuation.arrays import Array, largest
from continuation.budget import Budget
from continuation.citation import references_of, unique
from continuation.controllers import Controller, StepMeasures
from continuation.correctors import Corrector
from continuation.counts import Counts
from continuation.ends.divergence import divergence
from continuation.ends.endgame import SingularLimit
from continuation.ends.target import Target
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.evaluation.jacobian_check import check_jacobian
from continuation.events import Event
from continuation.events.scan import monitored
from continuation.homotopy import SupportsFinish, SupportsMaxStep, SupportsObserve
from continuation.metric import Metric, norm, share
from continuation.path import LocatedEvent, Path, Step
from continuation.point.arc import angle_between, length_between
from continuation.point.linearization import Anchor, Linearization
from continuation.predictors import Knot, Prediction, Predictor
from continuation.predictors.taylor import ORDERS
from continuation.presets import DEFAULT, Preset
from continuation.status import Kind, Status
from continuation.step.acceptance import Accepted, Examiner, residual_norm
from continuation.step.settings import complete_settings
from continuation.step.start import StartError, first_point, point_from_tangent
from continuation.step.state import State
from continuation.step.stepper import HIGH_ORDER_FRACTION, LOW_ORDER_FRACTION, Attempt, Stepper
from continuation.tolerance import Tolerance


class Observer(Protocol):
    """Something that watches a trace: an archive, a progress bar, a plot. It may not change the trace."""

    def step(self, tracer: Tracer, step: Step) -> None:
        """An accepted step; `tracer.state` is the state after it."""
        ...

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """A located event, before the step that holds it."""
        ...

    def end(self, tracer: Tracer) -> None:
        """The end; `tracer.path` is complete."""
        ...


class Tracer:
    """An iterator over the steps of one path.

    Parameters
    ----------
    homotopy : Homotopy
        `start` and `residual`; every other capability is found by its presence.
    predictor, corrector, controller : optional
        Parts; each overrides the preset's.
    preset : Preset
        `FAST`, `DEFAULT` or `CONSERVATIVE`.
    metric : Metric, optional
        The homotopy's own, else `Automatic`.
    events : sequence of Event
        Added to the homotopy's own. Turning points and branch points are always watched for.
    tolerance : float or Tolerance
    budget : Budget
    target : float or None, optional
        Overrides the homotopy's target; its default is 0.
    direction : int
        Sign of the parameter's first movement; 0 means towards the target.
    observers : sequence of Observer
    start : tuple of (u, tangent), optional
        Begin here instead of at the homotopy's start: ``(y, lam)`` as one vector and the direction to leave in.
    state : State, optional
        Resume from here: the steps that follow are bit for bit those of an uninterrupted trace.

    finish : callable, optional
        ``(y, lam)`` to the end y or None, tried after each step in place of the homotopy's own; no archive holds it.
    check_jacobian : bool
        Compare the Jacobian with the residual at the start, and refuse a wrong one with a ValueError that says where.
    examine : bool
        Watch for turning points and branch points, and look for a singular end by the endgame. Without it the path is
        only followed, at two thirds of the cost: a step over a branch point is refused, and an end must be regular, or
        be found by the homotopy's own `finish`. For searches that trace many paths for their ends.

    Attributes
    ----------
    settings : Settings
        The parts, the events, the tolerance, the budget and the target, completed and checked.
    path : Path
        All that was found so far.
    state : State or None
        What the next step needs.
    """

    def __init__(
        self,
        homotopy: Any,
        *,
        predictor: Predictor | None = None,
        corrector: Corrector | None = None,
        controller: Controller | None = None,
        preset: Preset = DEFAULT,
        metric: Metric | None = None,
        events: Sequence[Event] = (),
        tolerance: float | Tolerance = 1e-8,
        budget: Budget | None = None,
        target: float | str | None = "homotopy",
        direction: int = 0,
        observers: Sequence[Observer] = (),
        start: tuple[Array, Array] | None = None,
        state: State | None = None,
        finish: Callable[[Array, float], Array | None] | None = None,
        check_jacobian: bool = False,
        examine: bool = True,
    ) -> None:
        self.homotopy = homotopy
        self.path = Path()
        self.counts: Counts = self.path.counts
        self._evaluator = Evaluator(homotopy, self.counts)
        self.settings = complete_settings(
            homotopy,
            preset,
            predictor,
            corrector,
            controller,
            metric,
            events,
            tolerance,
            budget,
            target,
            direction,
            examine,
        )
        self.observers = tuple(observers)
        self.state: State | None = state
        max_step = homotopy.max_step if isinstance(homotopy, SupportsMaxStep) else None
        fraction = HIGH_ORDER_FRACTION if self.settings.predictor.order >= ORDERS[0] else LOW_ORDER_FRACTION
        stepper = Stepper(self._evaluator, self.settings.corrector, self.settings.tolerance, max_step, fraction)
        self._stepper = stepper
        self._ends = Target(stepper, self.settings.target)
        self._examiner = Examiner(self._evaluator, self.settings, self._ends)
        if finish is not None and not callable(finish):
            raise TypeError(f"finish: expected a function of (y, lam), found {finish!r}")
        own = homotopy.finish if isinstance(homotopy, SupportsFinish) else None
        self._finish = finish if finish is not None else own
        self._observe = homotopy.observe if isinstance(homotopy, SupportsObserve) else None
        self._start = start
        self._check = check_jacobian
        self._clock = time.perf_counter()

    @property
    def seconds(self) -> float:
        """Since the tracer was made."""
        return time.perf_counter() - self._clock

    @property
    def references(self) -> tuple[str, ...]:
        """BibTeX of the homotopy, of the parts, and of what served in the homotopy's stead, as far as used by now."""
        parts = (self.settings.predictor, self.settings.corrector, self.settings.controller)
        return unique((*references_of(self.homotopy, *parts), *sorted(self._evaluator.methods)))

    def __iter__(self) -> Iterator[Step]:
        """Trace: yields each accepted step, the start first, and ends when the path has a status."""
        try:
            yield from self._run()
        except KeyboardInterrupt:
            self._end(Status.INTERRUPTED)
        finally:
            # A consumer that stops iterating, or an exception of the plug-in's own, leaves a consistent path behind.
            if self.path.status is Status.TRACING:
                self._end(Status.INTERRUPTED)

    def _run(self) -> Iterator[Step]:
        try:
            point = self._first() if self.state is None else self._restored(self.state)
        except StartError as error:
            self._end(error.status, str(error))
            return
        if self.path.steps:
            yield self.path.steps[-1]
        while self.path.status is Status.TRACING:
            limit = self.settings.budget.spent(self.counts, self.seconds)
            if limit:
                self._end(Status.BUDGET_EXHAUSTED, f"{Status.BUDGET_EXHAUSTED} Reached: {limit}.")
                return
            known = len(self.path.steps)
            following = self._advance(point)
            if len(self.path.steps) > known:
                yield self.path.steps[-1]
            if following is None:
                return
            point = following

    # -- beginning and end ------------------------------------------------------------------------------------

    def _first(self) -> Linearization:
        settings = self.settings
        u0 = self._evaluator.start()
        if self._check:
            report = check_jacobian(self.homotopy)
            if not report.correct:
                raise ValueError(f"jacobian: {report}")
        if self._start is None:
            point = first_point(
                self._evaluator, u0, settings.metric, settings.tolerance, settings.direction, settings.target
            )
        else:
            point = point_from_tangent(self._evaluator, self._start, u0.size, settings.metric)
        r = largest(self._evaluator.residual(point.u))
        here = Knot(0.0, point.u, point.tangent)
        first = Step(
            0,
            point.u,
            point.tangent,
            0.0,
            residual_norm=r,
            orientation=point.orientation,
            kind=Kind.START,
            share=share(point.weights, point.tangent),
            observed=self._observed(point.u),
        )
        state = State(
            history=(here,),
            weights=point.weights,
            anchor=(point.anchor.u, point.anchor.border),
            orientation=point.orientation,
            h=settings.controller.bounds.cap(settings.controller.bounds.initial),
            controller=settings.controller.init(),
            monitors=tuple(monitored(event, point) for event in settings.events),
            occurrences=(0,) * len(settings.events),
            origin=here,
            origin_weights=point.weights,
            divergence_monitor=divergence((0.0, 0.0, 0.0), point.u, 0.0)[0],
        )
        # The state last: whatever interrupts before it, a resumed trace begins again and lacks nothing.
        self._record(first, state)
        if settings.target is not None and point.lam == settings.target and self._start is None:
            self._end(Status.REACHED_TARGET, f"{Status.REACHED_TARGET} The start lies on it.")
        return point

    def _restored(self, state: State) -> Linearization:
        """The point of a stored state: its factorisation is made anew from the same numbers, its tangent is kept."""
        u, v = state.here.u, state.here.tangent
        at, border = state.anchor
        anchor = Anchor(u if np.array_equal(at, u) else at, border, self._evaluator.factor(at, border))
        return Linearization(u, state.weights, anchor, v, state.orientation)

    def _end(self, status: Status, message: str = "") -> None:
        self.path.status = status
        self.path.message = message or str(status)
        self.path.seconds = self.seconds
        self.path.references = self.references
        for observer in self.observers:
            observer.end(self)

    def _observed(self, u: Array) -> Mapping[str, float]:
        """The homotopy's extra scalars at a point."""
        return {} if self._observe is None else self._observe(u[:-1], float(u[-1]))

    def _record(self, step: Step, state: State, events: Sequence[LocatedEvent] = ()) -> None:
        """Add a step, with the events before it, to the path, the state and the observers: all or, if cut off, none."""
        self.path.events.extend(events)
        self.path.steps.append(step)
        self.state = state
        for observer in self.observers:
            for event in events:
                # An event on which the path ends is the step itself: observers see it once.
                if event.u is not step.u:
                    observer.event(self, event)
            observer.step(self, step)

    # -- one step ---------------------------------------------------------------------------------------------

    def _advance(self, point: Linearization) -> Linearization | None:
        """The next accepted point, or None when the path has ended."""
        state = self.state
        assert state is not None
        try:
            prediction = self.settings.predictor.prepare(self._evaluator, point, state.history)
        except EvaluationError as error:
            self._end(Status.STEP_TOO_SMALL, f"{Status.STEP_TOO_SMALL} The predictor failed: {error}.")
            return None
        end = None
        if self.settings.examine:
            end, state = self._ended(point, prediction, state)
        if end is not None:
            self._append_end(point, end.u, _ending(Status.REACHED_TARGET, end), end)
            return None
        h, rejections, memory = min(state.h, prediction.reach), 0, state.controller
        if math.isinf(h):
            # A controller made for series with a predictor that has no range: begin with the size of the point.
            h = 1.0 + norm(point.weights, point.u)
        landing = self._ends.try_target(point, prediction, h, state.last_failed_landing)
        if landing is not None:
            if landing.landed:
                accepted = self._examiner.examine(point, evolve(state, index=state.index + 1), landing, 0, prediction)
                if accepted is not None:
                    return self._move(point, accepted)
            state = evolve(state, last_failed_landing=point.lam)
        while True:
            trial = self._stepper.attempt(point, prediction, self._stepper.shortened(point, prediction, h))
            decision = self.settings.controller.update(memory, self._measured(trial, rejections))
            memory = decision.state
            if decision.accept and trial.arrival is not None:
                draft = evolve(state, controller=memory, h=decision.h, index=state.index + 1)
                accepted = self._examiner.examine(point, draft, trial, rejections, prediction)
                if accepted is not None:
                    return self._move(point, accepted)
                decision = evolve(decision, h=trial.h / 2.0)
                trial = evolve(trial, reason="the arc is not on one path, as far as its determinant and inside tell")
            rejections += 1
            self.counts.rejected += 1
            # A step that ends in a branch point finds no factors there; halves of it would only creep up to the place.
            singular = trial.correction is not None and trial.correction.singular
            h = decision.h * (1.19 if singular else 1.0)
            if self._hopeless(trial, h):
                return None

    def _ended(self, point: Linearization, prediction: Prediction, state: State) -> tuple[SingularLimit | None, State]:
        """The end, where it is one that no step can reach; the state remembers what was tried."""
        end = self._ends.fold_at_target(point, prediction)
        if end is None and self._ends.endgame_is_due(point, state):
            return self._ends.endgame(point), evolve(state, last_failed_endgame=point.lam)
        return end, state

    def _measured(self, trial: Attempt, rejections: int) -> StepMeasures:
        correction = trial.correction
        return StepMeasures(
            h=trial.h,
            converged=trial.arrival is not None,
            iterations=correction.iterations if correction else 0,
            contraction=correction.contraction if correction else math.inf,
            distance=correction.distance if correction else math.inf,
            angle=trial.angle,
            order=self.settings.predictor.order,
            rejections=rejections,
        )

    def _hopeless(self, trial: Attempt, h: float) -> bool:
        """Whether the step fell below its floor, or the budget is spent: then the path ends, with the last reason."""
        limit = self.settings.budget.spent(self.counts, self.seconds)
        if limit:
            self._end(Status.BUDGET_EXHAUSTED, f"{Status.BUDGET_EXHAUSTED} Reached: {limit}.")
        elif h < self.settings.controller.bounds.minimum:
            status = Status.STEP_TOO_SMALL if trial.finite else Status.LEFT_DOMAIN
            reason = trial.reason or "the controller refuses even the shortest step, as with a wrong Jacobian"
            self._end(status, f"{status} Last reason: {reason}.")
        else:
            return False
        return True

    # -- after acceptance -------------------------------------------------------------------------------------

    def _move(self, point: Linearization, accepted: Accepted) -> Linearization | None:
        """Make the arrival the current point: metric, history, divergence, and the finish."""
        state, trial, ending = accepted.state, accepted.trial, accepted.ending
        arrival, correction = ending.arc.b, trial.correction
        assert correction is not None
        divergence_monitor, diverged = divergence(state.divergence_monitor, arrival.u, largest(state.origin.u[:-1]))
        weights = self.settings.metric.weights(arrival.u, arrival.tangent, arrival.weights)
        moved = arrival.with_weights(weights)
        whole = arrival is trial.arrival
        angle = trial.angle if whole else angle_between(point, arrival)
        step = Step(
            index=state.index,
            u=moved.u,
            tangent=arrival.tangent,
            arclength=state.here.arclength + length_between(point, arrival, angle),
            step_length=trial.h,
            residual_norm=correction.residual_norm if whole else residual_norm(self._evaluator, moved.u),
            orientation=moved.orientation,
            kind=ending.kind,
            corrector_iterations=correction.iterations,
            rejections=accepted.rejections,
            contraction=correction.contraction,
            distance=correction.distance,
            angle=angle,
            share=share(moved.weights, moved.tangent),
            segment=ending.arc.segment,
            weights=point.weights,
            observed=self._observed(moved.u),
        )
        knot = Knot(step.arclength, moved.u, moved.tangent)
        state = evolve(
            state,
            history=(*state.history, knot)[-max(self.settings.predictor.memory, 1) :],
            weights=moved.weights,
            anchor=(moved.anchor.u, moved.anchor.border),
            divergence_monitor=divergence_monitor,
            monitors=accepted.monitors,
            occurrences=accepted.occurrences,
        )
        self.counts.accepted += 1
        self._record(step, state, accepted.events)
        if ending.status is not Status.TRACING:
            if ending.limit is not None:
                self.path.end_error, self.path.winding_number = ending.limit.error, ending.limit.winding_number
            name = self.path.events[-1].name if ending.status is Status.STOPPED_AT_EVENT else ""
            self._end(ending.status, _ending(ending.status, ending.limit, name))
            return None
        if diverged:
            self._end(Status.DIVERGED)
            return None
        y = self._finish(moved.y, moved.lam) if self._finish is not None else None
        if y is not None:
            lam = self.settings.target if self.settings.target is not None else moved.lam
            message = f"{Status.REACHED_TARGET} The finish found the end."
            self._append_end(moved, np.append(y, lam), message)
            return None
        return moved

    def _append_end(self, point: Linearization, u: Array, message: str, limit: SingularLimit | None = None) -> None:
        """The end, found otherwise than by a step, as the last point."""
        before = self.path.steps[-1]
        chord = u - point.u
        length = norm(point.weights, chord)
        last = Step(
            index=before.index + 1,
            u=u,
            tangent=chord / length if length > 0.0 else point.tangent,
            arclength=before.arclength + length,
            step_length=length,
            residual_norm=residual_norm(self._evaluator, u),
            orientation=point.orientation,
            kind=Kind.TARGET,
            share=share(point.weights, point.tangent),
            observed=self._observed(u),
        )
        assert self.state is not None
        self.counts.accepted += 1
        self._record(last, self.state)
        if limit is not None:
            self.path.end_error, self.path.winding_number = limit.error, limit.winding_number
        self._end(Status.REACHED_TARGET, message)


def _ending(status: Status, limit: SingularLimit | None, event: str = "") -> str:
    """The status' sentence with what is particular to this end."""
    if event:
        return f"{status} It is: {event}."
    if limit is None:
        return str(status)
    power = f"|lam - target|^(1/{limit.winding_number})" if limit.winding_number > 1 else "lam - target"
    return f"{status} There it is a power series in {power}; error of the limit about {limit.error:.1g}."
