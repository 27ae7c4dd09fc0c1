"""The loop over accepted steps."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from typing import Any, Protocol, Unpack

import numpy as np

from continuation.arguments.labels import Labels
from continuation.arrays import Array
from continuation.citation import references_of, unique
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.jacobian_check import check_jacobian
from continuation.evaluation.pieces import Pieces, Signs
from continuation.events.scan import monitored
from continuation.homotopy import SupportsPieces, offers
from continuation.kinks.start import begin
from continuation.linear.silence import Silence
from continuation.linear.threads import one_thread
from continuation.path import LocatedEvent, Path, Step
from continuation.path.interrupted import Interrupted
from continuation.point.linearization import Anchor, Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Knot
from continuation.status import Kind, Status
from continuation.step.advance import Advance, Stopped
from continuation.step.capabilities import checked_end, finish_of, max_step_of
from continuation.step.options import Options, check_run, checked, documented
from continuation.step.record import StepRecorder, observing
from continuation.step.settings import complete_settings
from continuation.step.start import StartError, first_point, guessed, is_guess, point_and_direction, point_from_tangent
from continuation.step.state import State
from continuation.step.verdict import (
    INTERRUPTED,
    Verdict,
    abandoned,
    budget_spent,
    finished,
    raised,
    refused_start,
    start_on_target,
)


class Observer(Protocol):
    """Watches a trace: an archive, a progress bar, a plot."""

    def step(self, tracer: Tracer, step: Step) -> None:
        """Receive an accepted step; `tracer.state` is the state after it.

        Parameters
        ----------
        tracer : Tracer
        step : Step
        """
        ...

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """Receive a located event, before its step.

        Parameters
        ----------
        tracer : Tracer
        event : LocatedEvent
        """
        ...

    def end(self, tracer: Tracer) -> None:
        """Receive the end; `tracer.path` is complete.

        Parameters
        ----------
        tracer : Tracer
        """
        ...


@documented
class Tracer:
    """One path as an iterable of steps: ``for step in Tracer(homotopy)``.

    The loop may be left, and a second one continues, with clock and budget. Observers see the end of each loop.

    Parameters
    ----------
    homotopy : Homotopy
        Has `start`, `residual` and optional capabilities.
    observers : sequence of Observer, default ()
    state : State, default None
        Resume from here, bit for bit.
    {options}

    Attributes
    ----------
    settings : Settings
        The completed options.
    path : Path
    state : State or None

    Raises
    ------
    TypeError, ValueError
        For wrong input.
    """

    def __init__(
        self,
        homotopy: Any,
        *,
        observers: Sequence[Observer] = (),
        state: State | None = None,
        **options: Unpack[Options],
    ) -> None:
        asked = checked(options)
        check_run(observers, state)
        self.homotopy = homotopy
        self.path = Path(labels=Labels.of(homotopy))
        self.counts: Counts = self.path.counts
        self._evaluator = Evaluator(homotopy, self.counts)
        self.state: State | None = state
        given = asked["start"]
        self._guess = guessed(given) if is_guess(given) else None
        self._start = None if given is None or self._guess is not None else point_and_direction(given)
        self.settings = complete_settings(homotopy, asked, self._beginning, observers)
        self._bound = self.settings.bound(self._evaluator)
        self.observers = tuple(observers)
        self._finish = finish_of(homotopy, asked["finish"])
        self._pieces = Pieces(homotopy) if offers(homotopy, SupportsPieces) else None
        room, farthest = self.settings.room, max_step_of(homotopy)
        self._solver = PathSolver(self._evaluator, self.settings.tolerance, farthest, room)
        self._recorder = StepRecorder(self._evaluator, observing(homotopy, self._bound.events))
        self._advance = Advance(self._solver, self._bound, self._recorder, self._spent, self._pieces)
        self._check = asked["check_jacobian"]
        self._clock: float | None = None
        self._handed, self._reason = 0, ""

    @property
    def seconds(self) -> float:
        """Wall-clock seconds inside loops."""
        return self.path.seconds if self._clock is None else time.perf_counter() - self._clock

    @property
    def references(self) -> tuple[str, ...]:
        """BibTeX of homotopy, parts and replaced derivatives."""
        parts = (self.settings.predictor, self.settings.corrector, self.settings.controller)
        return unique((*references_of(self.homotopy, *parts), *sorted(self._evaluator.methods)))

    def __iter__(self) -> Iterator[Step]:
        """Yield accepted steps, the start first.

        Raises
        ------
        RuntimeError
            Inside another loop over this tracer.
        Interrupted
            After Ctrl-C: a KeyboardInterrupt with the path so far.
        """
        if self._clock is not None:
            raise RuntimeError("the tracer is being iterated already; leave that loop first")
        if self.path.status not in (Status.TRACING, Status.INTERRUPTED, Status.ABANDONED, Status.RAISED):
            return
        self._clock = time.perf_counter() - self.path.seconds
        self.path.status, self.path.message = Status.TRACING, ""
        try:
            yield from self._run()
        except KeyboardInterrupt as interrupt:
            if self.path.status is Status.TRACING:
                self._end(INTERRUPTED)
            raise Interrupted(self.path) from interrupt
        except BaseException as error:
            if self.path.status is Status.TRACING:
                self._end(abandoned(self._reason) if isinstance(error, GeneratorExit) else raised(error))
            raise

    @one_thread
    def run(self) -> Path:
        """Trace to the end.

        Raises
        ------
        Interrupted
            After Ctrl-C: a KeyboardInterrupt with the path so far.
        """
        deque(self, maxlen=0)  # in C, so that Ctrl-C arrives inside the tracer
        return self.path

    def give_up(self, reason: str) -> None:
        """Give the reason for leaving the loop, for message and archives.

        Parameters
        ----------
        reason : str
            A sentence without full stop.
        """
        self._reason = reason

    def _run(self) -> Iterator[Step]:
        try:
            with Silence():
                point = self._first() if self.state is None else self._restored(self.state)
        except StartError as error:
            self._end(refused_start(error))
            return
        if self._handed < len(self.path.steps):
            self._handed = len(self.path.steps)
            yield self.path.steps[-1]
        while self.path.status is Status.TRACING:
            verdict = budget_spent(self._spent(), self.state)
            if verdict is not None:
                self._end(verdict)
                return
            known = len(self.path.steps)
            following = self._next(point)
            if len(self.path.steps) > known:
                self._handed = len(self.path.steps)
                yield self.path.steps[-1]
            if following is None:
                return
            point = following

    def _spent(self) -> str:
        arclength = 0.0 if self.state is None else self.state.here.arclength
        return self.settings.budget.spent(self.counts, self.seconds, arclength)

    def _beginning(self) -> Array:
        if self._start is not None:
            return self._start[0]
        if self.state is not None:
            return self.state.origin.u
        return self._guess if self._guess is not None else self._evaluator.start()

    def _first(self) -> Linearization:
        settings = self.settings
        u0 = self._evaluator.start()
        given = self._start[0] if self._start is not None else u0 if self._guess is None else self._guess
        if given.size != u0.size:
            raise ValueError(f"start: expected {u0.size - 1} unknowns, found {given.size - 1}")
        if self._check:
            report = check_jacobian(self._evaluator.homotopy)
            if not report.correct:
                raise ValueError(f"jacobian: {report}")
        signs: Signs = ()
        if self._pieces is not None:
            point, h, signs = begin(
                self._solver, self._pieces, given, self._start, settings.metric, settings.direction, settings.target
            )
        elif self._start is None:
            point, h = first_point(self._solver, given, settings.metric, settings.direction, settings.target)
        else:
            point, h = point_from_tangent(self._solver, self._start, settings.metric, settings.target)
        here, bounds = Knot(0.0, point.u, point.tangent), settings.controller.bounds
        state = State(
            history=(here,),
            weights=point.weights,
            anchor=(point.anchor.u, point.anchor.border),
            orientation=point.orientation,
            h=bounds.cap(h if bounds.initial is None else bounds.initial),
            controller=settings.controller.init(),
            monitors=tuple(monitored(event, point) for event in self._bound.events),
            occurrences=(0,) * len(settings.events),
            origin=here,
            origin_weights=point.weights,
            signs=signs,
            noise=np.zeros(0) if self._evaluator.noise is None else self._evaluator.noise,
            tolerance=self._solver.tolerance.relative,
        )
        # State last: a trace interrupted before begins again.
        self._record(self._recorder.record(point, 0, 0.0, Kind.START), state)
        if self._start is None and (verdict := start_on_target(point.lam, settings.target)) is not None:
            self._end(verdict)
        return point

    def _restored(self, state: State) -> Linearization:
        at, border = state.anchor
        self._evaluator.noisy(state.noise)
        self._solver.noisy(state.tolerance)
        if self._pieces is not None:
            if len(state.signs) != self._pieces.values(at).size:
                raise ValueError(f"state: expected the signs of all switches, found {len(state.signs)}")
            self._evaluator.bind(self._pieces.piece(state.signs))
        anchor = Anchor(at, border, self._evaluator.factor(at, border))
        return Linearization(state.here.u, state.weights, anchor, state.here.tangent, state.orientation)

    def _end(self, verdict: Verdict) -> None:
        path = self.path
        path.status, path.message, path.rejected = verdict.status, str(verdict) + self._solver.noted, verdict.rejected
        path.end_error = verdict.error
        if verdict.limit is not None:
            path.end_error, path.winding_number = verdict.limit.error, verdict.limit.winding_number
        path.seconds, self._clock, path.references = self.seconds, None, self.references
        # All observers must be told: archives must close.
        with ExitStack() as telling:
            for observer in reversed(self.observers):
                telling.callback(observer.end, self)

    def _record(self, step: Step, state: State, events: Sequence[LocatedEvent] = ()) -> None:
        self.path.events.extend(events)
        self.path.steps.append(step)
        self.state = state
        for observer in self.observers:
            for event in events:
                if not event.ends_step:
                    observer.event(self, event)
            observer.step(self, step)

    def _next(self, point: Linearization) -> Linearization | None:
        state = self.state
        assert state is not None
        # Non-finite steps show overflow.
        with Silence():
            found = self._advance.advance(point, state)
        end, verdict = None, found.verdict
        if isinstance(found, Stopped):
            end = found.end
        else:
            point, state = found.point, found.state
            self.counts.accepted += 1
            self._record(found.step, state, self._recorder.observing(found.events))
            y = self._finish(point.y, point.lam) if verdict is None and self._finish is not None else None
            if y is not None:
                end = checked_end(self._evaluator, point.u, y, self.settings.target)
        if end is not None:
            last = self._recorder.end(point, state, end)
            self.counts.accepted += 1
            self._record(last, state)
            verdict = verdict or finished(last.residual_norm)
        if verdict is None:
            return point
        self._end(verdict)
        return None
