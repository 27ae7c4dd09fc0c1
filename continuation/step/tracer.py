"""The loop: an iterator of accepted steps. `continuation.trace` drives it."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any, Protocol

import numpy as np

from continuation.arrays import Array
from continuation.budget import Budget
from continuation.citation import references_of, unique
from continuation.controllers import Controller
from continuation.correctors import Corrector
from continuation.counts import Counts
from continuation.ends.divergence import divergence
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.jacobian_check import check_jacobian
from continuation.events import Event
from continuation.events.scan import monitored
from continuation.homotopy import SupportsFinish, SupportsObserve
from continuation.metric import Metric
from continuation.path import LocatedEvent, Path, Step
from continuation.point.linearization import Anchor, Linearization
from continuation.predictors import Knot, Predictor
from continuation.presets import DEFAULT, Preset
from continuation.status import Kind, Status
from continuation.step.advance import Advance, Stopped, solver_of
from continuation.step.record import StepRecorder
from continuation.step.settings import complete_settings
from continuation.step.start import StartError, first_point, point_from_tangent
from continuation.step.state import State
from continuation.step.verdict import FINISHED, INTERRUPTED, Verdict, budget_spent, refused_start, start_on_target
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
        self._finish = homotopy.finish if isinstance(homotopy, SupportsFinish) else None
        self._solver = solver_of(homotopy, self._evaluator, self.settings)
        observe = homotopy.observe if isinstance(homotopy, SupportsObserve) else None
        self._recorder = StepRecorder(self._evaluator, observe)
        self._advance = Advance(self._solver, self.settings, self._recorder, self._spent)
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
            self._end(INTERRUPTED)
        finally:
            # A consumer that stops iterating, or an exception of the plug-in's own, leaves a consistent path behind.
            if self.path.status is Status.TRACING:
                self._end(INTERRUPTED)

    def _run(self) -> Iterator[Step]:
        try:
            point = self._first() if self.state is None else self._restored(self.state)
        except StartError as error:
            self._end(refused_start(error))
            return
        if self.path.steps:
            yield self.path.steps[-1]
        while self.path.status is Status.TRACING:
            verdict = budget_spent(self._spent())
            if verdict is not None:
                self._end(verdict)
                return
            known = len(self.path.steps)
            following = self._next(point)
            if len(self.path.steps) > known:
                yield self.path.steps[-1]
            if following is None:
                return
            point = following

    def _spent(self) -> str:
        return self.settings.budget.spent(self.counts, self.seconds)

    # -- beginning and end ------------------------------------------------------------------------------------

    def _first(self) -> Linearization:
        settings = self.settings
        u0 = self._evaluator.start()
        if self._check:
            report = check_jacobian(self.homotopy)
            if not report.correct:
                raise ValueError(f"jacobian: {report}")
        if self._start is None:
            point = first_point(self._solver, u0, settings.metric, settings.direction, settings.target)
        else:
            point = point_from_tangent(self._evaluator, self._start, u0.size, settings.metric)
        here = Knot(0.0, point.u, point.tangent)
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
        self._record(self._recorder.record(point, 0, 0.0, Kind.START), state)
        verdict = start_on_target(point.lam, settings.target) if self._start is None else None
        if verdict is not None:
            self._end(verdict)
        return point

    def _restored(self, state: State) -> Linearization:
        """The point of a stored state: its factorisation is made anew from the same numbers, its tangent is kept."""
        at, border = state.anchor
        anchor = Anchor(at, border, self._evaluator.factor(at, border))
        return Linearization(state.here.u, state.weights, anchor, state.here.tangent, state.orientation)

    def _end(self, verdict: Verdict) -> None:
        path = self.path
        path.status, path.message, path.rejected = verdict.status, str(verdict), verdict.rejected
        if verdict.limit is not None:
            path.end_error, path.winding_number = verdict.limit.error, verdict.limit.winding_number
        path.seconds = self.seconds
        path.references = self.references
        for observer in self.observers:
            observer.end(self)

    def _record(self, step: Step, state: State, events: Sequence[LocatedEvent] = ()) -> None:
        """Add a step, with the events before it, to the path, the state and the observers: all or, if cut off, none."""
        self.path.events.extend(events)
        self.path.steps.append(step)
        self.state = state
        for observer in self.observers:
            for event in events:
                # An event on which the path ends is the step itself: observers see it once.
                if not event.ends_step:
                    observer.event(self, event)
            observer.step(self, step)

    def _next(self, point: Linearization) -> Linearization | None:
        """The point after one step, or None where the path has ended."""
        state = self.state
        assert state is not None
        found = self._advance.advance(point, state)
        end, verdict = None, found.verdict
        if isinstance(found, Stopped):
            end = found.end
        else:
            point, state = found.point, found.state
            self.counts.accepted += 1
            self._record(found.step, state, found.events)
            if verdict is None and self._finish is not None:
                y = self._finish(point.y, point.lam)
                if y is not None:
                    lam = self.settings.target if self.settings.target is not None else point.lam
                    end, verdict = np.append(y, lam), FINISHED
        if end is not None:
            last = self._recorder.end(point, state, end)
            self.counts.accepted += 1
            self._record(last, state)
        if verdict is None:
            return point
        self._end(verdict)
        return None
