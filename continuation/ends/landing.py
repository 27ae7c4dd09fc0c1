"""Landing on the target: by a step of its own, or where an accepted arc crosses it or touches it."""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array, dot, generic_vector
from continuation.contraction import HALVING, RELIABLE
from continuation.correctors import BorderedNewton
from continuation.evaluation.errors import EvaluationError
from continuation.events import TurningPoint
from continuation.events.locate import may_vanish, on_value, zero_between, zeros
from continuation.metric import norm, share
from continuation.point.arc import Arc, cut
from continuation.point.linearization import NEAR_SINGULAR, Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection
from continuation.step.stepper import Attempt, Stepper

RESOLUTION = 1e-9
"""Of the step to the target, relative: Newton's method at the target's parameter value does the rest."""

SINGULAR_SHARE = 1e-10
"""Share of the parameter in the tangent below which an end counts as singular in the parameter."""

DISTANCE, ANGLE = 0.3, 1.0
"""A landing that corrects the prediction by more than this fraction of the step, or turns the tangent by more than this
(radians), has landed on another branch."""

RETRY, LEAP = 0.3, 10.0
"""An interior path creeps towards a target on its boundary. There a landing is tried from so many step lengths away,
and again when so much of the way is left."""

STRETCH = 1.01
"""A target just beyond the step is landed on with it: a step of round-off would be left."""

ROOM, EDGE = 0.9, 1e-6
"""The least way to the boundary, in ways to the predicted end: a prediction may err by so much. The end itself may lie
on the boundary, to within the other."""

LANDING = BorderedNewton(max_iterations=8, max_contraction=RELIABLE)
"""It must contract well: at a fixed parameter a far solution is as good as the path's own."""


@frozen(eq=False)
class Landing:
    """Steps that end on the target."""

    stepper: Stepper
    target: float

    @property
    def lands_from_afar(self) -> bool:
        """Whether landing is tried from many steps away, now and then: near a boundary steps become short."""
        return self.stepper.solver.max_step is not None

    def attempt(
        self, point: Linearization, prediction: Prediction, h: float, longest: float, last_failed: float
    ) -> Attempt | None:
        """A step to the target, if the prediction reaches it.

        `h`: The step length that the controller wants, `longest`: the longest that it allows. `last_failed`: The
        parameter value at which landing was last tried in vain.
        """
        guess = self._guess(point, prediction, h, longest, last_failed)
        if guess is None:
            return None
        attempt = self._correct(point, *guess)
        if isinstance(attempt, Rejected):
            return attempt
        arrival = attempt.point
        if attempt.angle > ANGLE or share(arrival.weights, arrival.tangent) <= SINGULAR_SHARE:
            return Rejected(attempt.h, Rejection.ELSEWHERE, contraction=attempt.correction.contraction)
        return attempt

    def _guess(
        self, point: Linearization, prediction: Prediction, h: float, longest: float, last_failed: float
    ) -> tuple[Array, float] | None:
        """The predicted point with the target's parameter value, and its step, if that is within reach."""
        gap = self.target - point.lam
        if gap * point.tangent[-1] <= 0.0:
            return None
        target, max_step = self.target, self.stepper.solver.max_step
        if self.lands_from_afar:
            if abs(gap) > RETRY * abs(last_failed - target):
                return None
            h = min(LEAP * h, longest)
        high = min(prediction.reach, STRETCH * h)
        try:
            if not (prediction(high)[-1] - target) * gap >= 0.0:
                return None
            reached = zero_between(lambda s: float(prediction(s)[-1]) - target, 0.0, high, xtol=RESOLUTION * high)
            if reached is None:
                return None
            guess = prediction(reached).copy()
        except EvaluationError:
            return None
        guess[-1] = target
        if max_step is not None and max_step(point.u, guess - point.u) < ROOM:
            return None
        return guess, reached

    def _correct(self, point: Linearization, guess: Array, h: float) -> Attempt:
        """The parameter of `guess` is kept: the border is e_{N+1}."""
        solver = self.stepper.solver
        unit = np.zeros_like(guess)
        unit[-1] = 1.0
        correction = LANDING.correct(solver.evaluator, point, guess, unit, solver.tolerance)
        rejected = correction.rejected(h)
        if rejected is not None:
            return rejected
        border = point.border
        along = dot(border, correction.u - point.u)
        if along <= 0.0 or correction.distance > DISTANCE * h:
            return Rejected(h, Rejection.ELSEWHERE, contraction=correction.contraction)
        # The target may lie on the boundary of the domain, so the end itself is exempt from the ratio test.
        if solver.max_step is not None and solver.max_step(point.u, correction.u - point.u) < 1.0 - EDGE:
            return Rejected(h, Rejection.OUTSIDE, contraction=correction.contraction)
        landed = evolve(correction, u=np.append(correction.u[:-1], self.target))
        return self.stepper.arrive(point, border, h, landed)


def crossing(solver: PathSolver, arc: Arc, value: float) -> Linearization | None:
    """Where the arc first takes a parameter value that its ends enclose, or that it touches in a fold."""

    def gap(u: Array, v: Array) -> float:
        return float(u[-1]) - value

    before, after = arc.a.lam - value, arc.b.lam - value
    if before == 0.0 or not may_vanish(gap, arc, before, after):
        return None
    if before * after > 0.0:
        # An asymptote gets as near as 1e-250, and the least value of a polynomial between two such ends is noise.
        if max(abs(before), abs(after)) <= solver.noise_by_component(arc.a)[-1]:
            return None
        ends = float(arc.a.tangent[-1]), float(arc.b.tangent[-1])
        if ends[0] * ends[1] < 0.0 and before * ends[0] < 0.0:
            # The parameter came nearer and turned away again: a fold that lies on the target as far as H can tell is
            # the end, and a path that passes through the target on its way to a fold just behind it ends there.
            fold = next(zeros(solver, TurningPoint().monitor, arc, *ends), None)
            if fold is None:
                return None
            # What is left of the slope at the fold, as where branches cross in it, leaves so much of the parameter.
            left = float(fold.tangent[-1]) ** 2 * arc.length / abs(ends[1] - ends[0])
            if abs(fold.lam - value) <= solver.noise_by_component(fold)[-1] + left:
                return fold
            arc, after = cut(arc, fold), fold.lam - value
            if before * after > 0.0:
                return None
    found = next(zeros(solver, gap, arc, before, after), None)
    return None if found is None else on_value(solver, found, -1, value)


def regular(solver: PathSolver, end: Linearization, near: Linearization) -> bool:
    """Whether H' has full rank at a point that was corrected with the factorisation of `near`: if not, that is no end.

    Where H_y vanishes at the target, as in lam F(y), anything solves H = 0 there. Refinement of a general right-hand
    side contracts if H' is that of `near` but for a moderate change. If it does not, H' is factored at the point.
    """
    evaluator, r = solver.evaluator, generic_vector(end.u.size - 1)
    z = near.solve(r)
    size = norm(near.weights, z)
    apply = evaluator.differential(end.u)
    if apply is None or norm(near.weights, near.solve(r - apply(z))) <= HALVING * size:
        return True
    try:
        return norm(near.weights, evaluator.factor(end.u, near.border).solve(r, 0.0)) <= NEAR_SINGULAR * size
    except EvaluationError:
        return False
