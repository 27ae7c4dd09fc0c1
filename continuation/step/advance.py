"""One step: from a point to the next accepted point."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from attrs import define, evolve, field, frozen

from continuation.arrays import Array
from continuation.controllers import StepMeasures
from continuation.ends.divergence import divergence
from continuation.ends.endgame import SingularLimit
from continuation.ends.landing import Landing
from continuation.ends.target import Target
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.pieces import Pieces
from continuation.events import Event, TurningPoint
from continuation.kinks.first import same_piece
from continuation.kinks.through import STILL, Crossing
from continuation.metric import SupportsExtent, norm
from continuation.path import LocatedEvent, Step
from continuation.point.arc import angle_between, length_between
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Knot, Prediction
from continuation.rejection import Rejected, Rejection
from continuation.step.acceptance import Accepted, Examiner
from continuation.step.crossing import between
from continuation.step.record import StepRecorder
from continuation.step.settings import Settings
from continuation.step.start import CLEAR_OF_NOISE, COARSEST
from continuation.step.state import State
from continuation.step.stepper import LOW_ORDER_FRACTION, Arrival, Attempt, Stepper
from continuation.step.verdict import (
    Verdict,
    arc_ended,
    behind_kink,
    budget_spent,
    no_step_left,
    predictor_failed,
    singular_end,
)

SINGULAR_STRETCH = 1.19
"""Factor of the next step after a singular factorisation; halving creeps up to the branch point. Without it 720 traces
had 648 rejections and 9 stuck; with 1.1 to 1.5, 132 to 144 and none."""

INSIDE = (Rejection.MIDPOINT, Rejection.CROSSINGS, Rejection.OTHER_BRANCH)
"""Reasons to reject a landing that hold for longer arcs too."""

NOISE_ASKED, NOISE_GROWN = (2, 12), 4.0
"""Attempts at one step after which H's noise is measured again; factor by which it must grow, since two measurements
differ by less."""


@frozen(eq=False)
class Moved:
    """An accepted step."""

    point: Linearization
    step: Step
    state: State
    events: list[LocatedEvent]
    verdict: Verdict | None


@frozen(eq=False)
class Stopped:
    """The path ends without a step; `end`: its limit, if found."""

    verdict: Verdict
    end: Array | None = None


@define(eq=False)
class Advance:
    """Makes the steps of one path.

    `spent`: names the exhausted limit of the budget, or "".
    """

    solver: PathSolver
    settings: Settings
    recorder: StepRecorder
    spent: Callable[[], str]
    pieces: Pieces | None = None
    stepper: Stepper = field(init=False)
    target: Target = field(init=False)
    landing: Landing | None = field(init=False)
    examiner: Examiner = field(init=False)
    extent: SupportsExtent | None = field(init=False)

    def __attrs_post_init__(self) -> None:
        solver, settings = self.solver, self.settings
        fraction = getattr(settings.predictor, "interior_fraction", LOW_ORDER_FRACTION)
        self.stepper = Stepper(solver, settings.corrector, fraction)
        self.target = Target(solver, settings.target)
        self.landing = None if settings.target is None else Landing(self.stepper, settings.target)
        self.examiner = Examiner(solver, settings, self.target, self.pieces)
        self.extent = settings.metric if isinstance(settings.metric, SupportsExtent) else None

    def advance(self, point: Linearization, state: State) -> Moved | Stopped:
        """Make one step."""
        settings, controller = self.settings, self.settings.controller
        try:
            prediction = settings.predictor.prepare(self.solver.evaluator, point, state.history)
        except EvaluationError as error:
            noisy = self._noisier(point, state, point.u)
            return Stopped(predictor_failed(error)) if noisy is None else self.advance(point, noisy)
        limit, state = self._limit_ahead(point, state)
        if limit is not None:
            return Stopped(singular_end(limit), limit.u)
        h, memory = min(state.h, prediction.reach), state.controller
        if self.extent is not None:
            h = min(h, self.extent.longest)
        if math.isinf(h):
            # Neither controller nor predictor has a range: begin with the point's size.
            h = 1.0 + norm(point.weights, point.u)
        landing = self.landing and self.landing.attempt(point, prediction, h)
        if landing is not None:
            if (
                isinstance(landing, Arrival)
                and controller.update(memory, self._measures(landing, prediction, 0)).accept
            ):
                found = self.examiner.examine(point, state, landing, prediction, landed=True)
                if isinstance(found, Accepted):
                    return self._moved(point, state, found, memory, state.h, ())
                if found.reason in INSIDE:
                    h = min(h, found.factor * landing.h)
            state = evolve(state, last_failed_landing=point.lam)
        rejected: tuple[Rejected, ...] = ()
        while True:
            attempt = self.stepper.attempt(point, prediction, self.stepper.shortened(point, prediction, h))
            decision = controller.update(memory, self._measures(attempt, prediction, len(rejected)))
            memory, h = decision.state, decision.h
            if isinstance(attempt, Rejected):
                failed = attempt
            elif not decision.accept:
                failed = Rejected(attempt.h, Rejection.CONTROLLER, contraction=attempt.correction.contraction)
            else:
                examined = self.examiner.examine(point, state, attempt, prediction, landed=False)
                if isinstance(examined, Accepted):
                    return self._moved(point, state, examined, memory, h, rejected)
                failed, h = examined, attempt.h * examined.factor
            rejected = (*rejected, failed)
            self.solver.evaluator.counts.rejected += 1
            if failed.reason is Rejection.SINGULAR:
                h *= SINGULAR_STRETCH
            asked = state.index > 0 and len(rejected) in NOISE_ASKED
            noisy = self._noisier(point, state, prediction(failed.h)) if asked else None
            if noisy is not None:
                h = min(state.h, prediction.reach) if noisy.tolerance > state.tolerance else h
                state = noisy
            verdict = budget_spent(self.spent(), state, rejected)
            verdict = verdict or no_step_left(h, controller.bounds.minimum, rejected)
            if verdict is not None:
                return Stopped(verdict)

    def _noisier(self, point: Linearization, state: State, u: Array) -> State | None:
        """The state with the noise found at u, or None if it has not grown."""
        evaluator, known = self.solver.evaluator, state.noise if state.noise.size else np.zeros(u.size - 1)
        try:
            evaluator.measure_noise(u, point.tangent, evaluator.residual(u))
            noise = known if evaluator.noise is None else np.maximum(evaluator.noise, known)
            grown = bool((noise > NOISE_GROWN * known).any())
            least = min(max(CLEAR_OF_NOISE * point.blur(noise), state.tolerance), COARSEST)
        except EvaluationError:
            grown = False
        # Evaluator and state must be equal for resumed traces.
        evaluator.noisy(noise if grown else known)
        if not grown:
            return None
        self.solver.noisy(least)
        return evolve(state, noise=noise, tolerance=least)

    def _limit_ahead(self, point: Linearization, state: State) -> tuple[SingularLimit | None, State]:
        """The singular end, if the endgame finds one, and the state, which remembers the attempt."""
        limit = None
        if self.target.endgame_is_due(point, state):
            limit, state = self.target.endgame(point), evolve(state, last_failed_endgame=point.lam)
        if limit is not None and self.pieces is not None and not same_piece(self.pieces, state.signs, point, limit.u):
            limit = None
        if limit is not None and point.orientation == 0 and between(self.solver, point, limit.u):
            # Without determinants only eigenvalues show that the limit is on another branch.
            limit = None
        return limit, state

    def _measures(self, attempt: Attempt, prediction: Prediction, rejections: int) -> StepMeasures:
        order = getattr(prediction, "order", self.settings.predictor.order)
        if isinstance(attempt, Rejected):
            return StepMeasures(attempt.h, order, rejections, rejection=attempt.reason)
        found = attempt.correction
        return StepMeasures(
            attempt.h, order, rejections, found.iterations, found.contraction, found.distance, attempt.angle
        )

    def _weights(self, arrival: Linearization, state: State) -> Array:
        if self.extent is not None:
            return self.extent.grown(arrival.weights, state.origin.u, arrival.u)
        return self.settings.metric.weights(arrival.u, arrival.tangent, arrival.weights)

    def _moved(
        self,
        point: Linearization,
        state: State,
        accepted: Accepted,
        memory: tuple[float, ...],
        h: float,
        rejected: tuple[Rejected, ...],
    ) -> Moved:
        attempt, ending = accepted.attempt, accepted.ending
        arrival, correction = ending.arc.b, attempt.correction
        monitor, infinity = divergence(
            state.divergence_monitor, arrival, state.origin, self.solver.evaluator, self.settings.stops
        )
        moved = arrival.with_weights(self._weights(arrival, state))
        if self.extent is not None:
            h *= norm(moved.weights, arrival.tangent) / norm(arrival.weights, arrival.tangent)
        angle = attempt.angle if ending.whole else angle_between(point, arrival)
        step = self.recorder.record(
            moved,
            state.index + 1,
            state.here.arclength + length_between(point, arrival, angle),
            ending.kind,
            residual_norm=correction.residual_norm if ending.whole else math.nan,
            tangent=arrival.tangent,
            step_length=attempt.h,
            corrector_iterations=correction.iterations,
            rejections=len(rejected),
            rejected=rejected,
            contraction=correction.contraction,
            distance=correction.distance,
            angle=angle,
            segment=ending.arc.segment,
            weights=point.weights,
        )
        knot = Knot(step.arclength, moved.u, moved.tangent)
        # `evolve` is too slow here.
        state = State(
            history=(*state.history, knot)[-max(self.settings.predictor.memory, 1) :],
            weights=moved.weights,
            anchor=(moved.anchor.u, moved.anchor.border),
            orientation=accepted.orientation,
            h=h,
            controller=memory,
            divergence_monitor=monitor,
            monitors=accepted.monitors,
            occurrences=accepted.occurrences,
            origin=state.origin,
            origin_weights=state.origin_weights,
            last_failed_landing=state.last_failed_landing,
            last_failed_endgame=state.last_failed_endgame,
            index=step.index,
            signs=state.signs,
            noise=state.noise,
            tolerance=state.tolerance,
        )
        event = accepted.events[-1].name if accepted.events else ""
        verdict = arc_ended(ending, infinity, event)
        if accepted.crossing is not None and verdict is None:
            verdict = behind_kink(accepted.crossing, self.solver, state.origin)
            if self.pieces is not None and accepted.crossing.onward is not None:
                moved, state = self._behind(self.pieces, accepted.crossing, accepted.crossing.onward, moved, state)
        return Moved(moved, step, state, accepted.events, verdict)

    def _behind(
        self, pieces: Pieces, crossing: Crossing, onward: Linearization, kink: Linearization, state: State
    ) -> tuple[Linearization, State]:
        self.solver.evaluator.bind(pieces.piece(crossing.signs))
        point = onward.with_weights(kink.weights)
        state = evolve(
            state,
            history=(Knot(state.here.arclength, point.u, point.tangent),),
            anchor=(point.anchor.u, point.anchor.border),
            orientation=point.orientation,
            monitors=tuple(
                self._monitor_behind(event, point, g) for event, g in zip(self.settings.events, state.monitors)
            ),
            signs=crossing.signs,
        )
        return point, state

    def _monitor_behind(self, event: Event, point: Linearization, before: float) -> float:
        g = event.monitor(point.u, point.tangent)
        moves = isinstance(event, TurningPoint) and abs(g) * math.sqrt(point.weights[event.component]) > STILL
        # A tiny number with the sign before.
        return g if moves or not isinstance(event, TurningPoint) else float(np.sign(before) * np.finfo(float).tiny)
