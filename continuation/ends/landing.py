"""Landing on the target by a step, or at a crossing."""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, dot, generic_vector
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

SINGULAR_SHARE = 1e-10
"""Parameter's share of the tangent below which an end is singular."""

LANDING = BorderedNewton(max_contraction=RELIABLE)
"""Correctors at a fixed parameter must contract well: far solutions satisfy H as well."""


@frozen(eq=False)
class Landing:
    """Steps that end on the target."""

    stepper: Stepper
    target: float

    def attempt(self, point: Linearization, prediction: Prediction, h: float) -> Attempt | None:
        """A step to the target if the prediction reaches it, else None.

        `h`: the controller's step.
        """
        guess = self._guess(point, prediction, h)
        if guess is None:
            return None
        attempt = self._correct(point, *guess)
        if isinstance(attempt, Rejected):
            return attempt
        arrival = attempt.point
        if share(arrival.weights, arrival.tangent) <= SINGULAR_SHARE:
            return Rejected(attempt.h, Rejection.ELSEWHERE, contraction=attempt.correction.contraction)
        return attempt

    def _guess(self, point: Linearization, prediction: Prediction, h: float) -> tuple[Array, float] | None:
        gap = self.target - point.lam
        if gap * point.tangent[-1] <= 0.0:
            return None
        high = min(prediction.reach, h)
        try:
            reached = zero_between(
                lambda s: float(prediction(s)[-1]) - self.target, 0.0, high, xtol=ROOT_OF_ROUND_OFF * high
            )
            if reached is None:
                return None
            return np.append(prediction(reached)[:-1], self.target), reached
        except EvaluationError:
            return None

    def _correct(self, point: Linearization, guess: Array, h: float) -> Attempt:
        solver = self.stepper.solver
        unit = np.append(np.zeros(guess.size - 1), 1.0)
        correction = LANDING.correct(solver.evaluator, point, guess, unit, solver.tolerance)
        rejected = correction.rejected(h)
        if rejected is not None:
            return rejected
        if dot(point.border, correction.u - point.u) <= 0.0:
            return Rejected(h, Rejection.ELSEWHERE, contraction=correction.contraction)
        # The end may lie on the boundary.
        if solver.max_step is not None and solver.max_step(point.u, correction.u - point.u) < 1.0 - SIX_DIGITS:
            return Rejected(h, Rejection.OUTSIDE, contraction=correction.contraction)
        landed = evolve(correction, u=np.append(correction.u[:-1], self.target))
        return self.stepper.arrive(point, point.border, h, landed)


def crossing(solver: PathSolver, arc: Arc, value: float) -> Linearization | None:
    """The first point of an arc at a parameter value, enclosed or touched by a fold."""

    def gap(u: Array, v: Array) -> float:
        return float(u[-1]) - value

    before, after = arc.a.lam - value, arc.b.lam - value
    if before == 0.0 or not may_vanish(gap, arc, before, after):
        return None
    if before * after > 0.0:
        ends = float(arc.a.tangent[-1]), float(arc.b.tangent[-1])
        if ends[0] * ends[1] < 0.0 and before * ends[0] < 0.0:
            # A fold on the target, to round-off, is the end; else the crossing just before the fold.
            fold = next(zeros(solver, TurningPoint().monitor, arc, *ends), None)
            if fold is None:
                return None
            # The slope left at the fold, as at crossing branches, leaves this much of the parameter.
            left = float(fold.tangent[-1]) ** 2 * arc.length / abs(ends[1] - ends[0])
            if abs(fold.lam - value) <= solver.noise_by_component(fold)[-1] + left:
                return fold
            arc, after = cut(arc, fold), fold.lam - value
            if before * after > 0.0:
                return None
    found = next(zeros(solver, gap, arc, before, after), None)
    return None if found is None else on_value(solver, found, -1, value)


def regular(solver: PathSolver, end: Linearization, near: Linearization) -> bool:
    """Whether H' has full rank at a point corrected with the factorisation of `near`.

    If H_y vanishes at the target, as in lam F(y), any y solves H = 0. H' is factored unless refinement of a general
    right-hand side contracts.
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
