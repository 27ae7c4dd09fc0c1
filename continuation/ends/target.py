"""Where a path ends: landing on the target, ends that are singular, returns to the start."""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen
from scipy.optimize import brentq

from continuation.arrays import Array, generic_vector, largest
from continuation.ends.closed_curve import passes_start
from continuation.ends.endgame import RELATIVE_FLOOR, SingularLimit, endgame, touching
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.events import TargetValue, TurningPoint
from continuation.events.locate import locate
from continuation.metric import norm, share
from continuation.point.arc import Arc, cut
from continuation.point.linearization import Linearization
from continuation.predictors import Prediction, SupportsSegment
from continuation.status import Kind, Status
from continuation.step.state import State
from continuation.step.stepper import Attempt, Stepper
from continuation.tolerance import Tolerance

ENDGAME = 1e-2
"""How near to the target, as a fraction of the whole way, a singular end is looked for."""

RESOLUTION = 1e-9
"""Of the step to the target, relative: Newton's method at the target's parameter value does the rest."""

SINGULAR = 1e-10
"""Share of the parameter in the tangent below which an end counts as singular in the parameter."""


ROUND_OFF = 1e-13
"""How near a fold must be to the target, relative to max(1, |target|), to lie on it."""


def crossing(evaluator: Evaluator, arc: Arc, value: float, tolerance: Tolerance) -> Linearization | None:
    """Where the arc first takes a parameter value that its ends enclose, or that it touches in a fold."""
    before, after = arc.a.lam - value, arc.b.lam - value
    if before * after < 0.0:
        points = locate(evaluator, TargetValue(value), arc, before, after, tolerance)
        return points[0] if points else None
    if before == 0.0 or arc.a.tangent[-1] * arc.b.tangent[-1] >= 0.0 or before * arc.a.tangent[-1] >= 0.0:
        return None
    # The parameter came nearer and turned away again: a fold on the target is an end, and so is what lies beyond it.
    nearest = min((arc.segment.at(t)[-1] - value) * np.sign(before) for t in np.linspace(0.0, 1.0, 9))
    if nearest > 0.5 * min(abs(before), abs(after)):
        return None
    fold = locate(evaluator, TurningPoint(), arc, float(arc.a.tangent[-1]), float(arc.b.tangent[-1]), tolerance)
    if not fold:
        return None
    gap = (fold[0].lam - value) * np.sign(before)
    # The fold is located to round-off, and so is its parameter value: a path that passes through the target on its
    # way to a fold just behind it ends on the target.
    scale = ROUND_OFF * max(1.0, abs(value))
    if abs(gap) <= scale:
        return fold[0]
    return crossing(evaluator, cut(arc, fold[0]), value, tolerance) if gap < 0.0 else None


def regular(evaluator: Evaluator, end: Linearization, near: Linearization) -> bool:
    """Whether H' has full rank at a point that was corrected with the factorisation of `near`: if not, that is no end.

    Where H_y vanishes at the target, as in lam F(y), anything solves H = 0 there. Refinement of a general right-hand
    side contracts if H' is that of `near` but for a moderate change. If it does not, H' is factored at the point.
    """
    r = generic_vector(end.u.size - 1)
    z = near.solve(r)
    size = norm(near.weights, z)
    apply = evaluator.differential(end.u)
    if apply is None or norm(near.weights, near.solve(r - apply(z))) <= 0.5 * size:
        return True
    try:
        return norm(near.weights, evaluator.factor(end.u, near.border).solve(r, 0.0)) <= size / SINGULAR
    except EvaluationError:
        return False


@frozen(eq=False)
class ArcEnd:
    """An accepted arc, cut where the path ends on it if it does; `limit` is set where the end is singular."""

    arc: Arc
    kind: int = Kind.REGULAR
    status: Status = Status.TRACING
    limit: SingularLimit | None = None


@frozen(eq=False)
class Target:
    """The target of a trace and the ways to end on it."""

    stepper: Stepper
    target: float | None

    # A homotopy with `max_step` has a domain, and its target mostly lies on the boundary. Three decisions follow, each
    # for a reason of its own.

    @property
    def lands_from_afar(self) -> bool:
        """Whether landing is tried from many steps away, now and then: near a boundary steps become short."""
        return self.stepper.max_step is not None

    @property
    def expects_singular_end(self) -> bool:
        """Whether the endgame is tried before any landing has failed: on the boundary H' may lose its rank."""
        return self.stepper.max_step is not None

    @property
    def may_turn_back(self) -> bool:
        """Whether the start's parameter value is an end: beyond it such a homotopy has no meaning."""
        return self.stepper.max_step is not None

    # -- before a step ----------------------------------------------------------------------------------------

    def try_target(self, point: Linearization, prediction: Prediction, h: float, last_failed: float) -> Attempt | None:
        """A landing on the target, if the prediction reaches it; a Attempt that failed where landing did."""
        guess = self._guess(point, prediction, h, last_failed)
        if guess is None:
            return None
        trial = self.stepper.correct_at_target(point, *guess)
        arrival = trial.arrival
        if arrival is None or trial.angle > 1.0 or share(arrival.weights, arrival.tangent) <= SINGULAR:
            return evolve(trial, landed=False)
        return trial

    def _guess(
        self, point: Linearization, prediction: Prediction, h: float, last_failed: float
    ) -> tuple[Array, float] | None:
        """The predicted point with the target's parameter value, and its step, if that is within reach."""
        if self.target is None:
            return None
        gap = self.target - point.lam
        if gap * point.tangent[-1] <= 0.0:
            return None
        if self.lands_from_afar and abs(gap) > 0.3 * abs(last_failed - self.target):
            return None
        # An interior path creeps towards a target on its boundary, so there a longer jump is tried, now and then.
        target, high = self.target, min(prediction.reach, 10.0 * h if self.lands_from_afar else h)
        try:
            if not (prediction(high)[-1] - target) * gap >= 0.0:
                return None
            high = float(brentq(lambda s: prediction(s)[-1] - target, 0.0, high, xtol=RESOLUTION * high))
            guess = prediction(high).copy()
        except EvaluationError:
            return None
        guess[-1] = self.target
        if self.stepper.max_step is not None and self.stepper.max_step(point.u, guess - point.u) < 0.9:
            return None
        return guess, high

    def fold_at_target(self, point: Linearization, prediction: Prediction) -> SingularLimit | None:
        """The end where a series sees the parameter touch its target in a fold: a half-power end, found as a fold.

        The far side of the fold lies outside the domain of an interior homotopy, but the formulas mostly do not mind;
        where they do, the endgame is still there.
        """
        if self.target is None or not hasattr(prediction, "segment"):
            return None
        assert isinstance(prediction, SupportsSegment)
        fold = touching(prediction, point, self.target)
        if fold is None:
            return None
        far = min(2.0 * fold, prediction.reach)
        trial = evolve(self.stepper, max_step=None).attempt(point, prediction, far)
        if trial.arrival is None:
            return None
        arc = Arc(point, trial.arrival, point.border, prediction.segment(far, trial.arrival.u))
        try:
            end = crossing(self.stepper.evaluator, arc, self.target, self.stepper.tolerance)
            return None if end is None else self._limit(arc, end, self.target)
        except EvaluationError:
            return None

    def endgame_is_due(self, point: Linearization, state: State) -> bool:
        """Whether the path is so near the target that a singular end is to be looked for.

        An interior path creeps towards a singular end on its boundary; any path may have failed to land. Asked for
        again only when the parameter has come nearer by a good factor.
        """
        if self.target is None or state.index == 0:
            return False
        gap, whole = point.lam - self.target, float(state.origin.u[-1]) - self.target
        near = abs(gap) <= ENDGAME * abs(whole) and gap * point.tangent[-1] < 0.0
        failed = state.last_failed_landing == point.lam or self.expects_singular_end
        return near and failed and abs(gap) <= 0.05 * abs(state.last_failed_endgame - self.target)

    def endgame(self, point: Linearization) -> SingularLimit | None:
        """The limit at the target by the endgame."""
        assert self.target is not None
        stepper = self.stepper
        try:
            return endgame(stepper.evaluator, point, self.target, stepper.tolerance, stepper.max_step)
        except EvaluationError:
            return None

    # -- after a step -----------------------------------------------------------------------------------------

    def ending_of_arc(self, arc: Arc, state: State) -> ArcEnd:
        """Where the path ends on an accepted arc: at the target, at its own start, or beyond the start's parameter."""
        evaluator, tolerance = self.stepper.evaluator, self.stepper.tolerance
        ends = []
        if self.target is not None:
            ends.append((self.target, Kind.TARGET, Status.REACHED_TARGET))
            if self.may_turn_back and state.index > 0:
                ends.append((float(state.origin.u[-1]), Kind.REGULAR, Status.TURNED_BACK))
        for value, kind, status in ends:
            point = crossing(evaluator, arc, value, tolerance)
            if point is not None:
                limit = self._limit(arc, point, value) if kind == Kind.TARGET else None
                u: Array = np.append(point.u[:-1], value) if limit is None else limit.u
                end = Linearization(u, point.weights, point.anchor, point.tangent, point.orientation)
                return ArcEnd(cut(arc, end), kind, status, limit)
        origin = state.origin
        if state.index > 0 and passes_start(evaluator, origin, state.origin_weights, arc, tolerance):
            b = arc.b
            end = Linearization(origin.u, b.weights, b.anchor, origin.tangent, b.orientation)
            return ArcEnd(cut(arc, end), Kind.REGULAR, Status.CLOSED)
        return ArcEnd(arc)

    def _limit(self, arc: Arc, end: Linearization, value: float) -> SingularLimit | None:
        """The end of the arc where it is singular; None where it is regular, or a fold about which no more can be said.

        In a simple fold the end is known to round-off. Where the parameter stands still to a higher order it is known
        to a root of round-off only, and the endgame says more. Which it is, is seen from the beginning of the arc:
        lam - value ~ sigma^w, so the ratio below is near 1/w.
        """
        stepper = self.stepper
        if share(end.weights, end.tangent) > SINGULAR:
            if regular(stepper.evaluator, end, arc.a):
                return None
            limit = endgame(stepper.evaluator, arc.a, value, stepper.tolerance, stepper.max_step)
            if limit is None:
                raise EvaluationError("the end is singular, and its limit was not found")
            return limit
        sigma = float(np.dot(arc.border, end.u - arc.a.u))
        gap, expected = abs(arc.a.lam - value), abs(sigma * arc.a.tangent[-1])
        fold = None
        if (arc.a.lam - value) * (arc.b.lam - value) >= 0.0 and 0.4 * expected < gap < 0.8 * expected:
            # y ~ y* + c sqrt(lam - value), with c as at the beginning of the arc.
            fold = SingularLimit(
                np.append(end.u[:-1], value), (abs(end.lam - value) / gap) ** 0.5 * largest(arc.a.y - end.y), 2
            )
            if fold.error <= RELATIVE_FLOOR * (1.0 + largest(end.u)):
                return fold
        limit = endgame(stepper.evaluator, arc.a, value, stepper.tolerance, stepper.max_step)
        return fold if limit is None or (fold is not None and fold.error <= limit.error) else limit
