"""One attempt at a step."""

from __future__ import annotations

import math
from typing import TypeAlias

from attrs import frozen

from continuation.arrays import SIX_DIGITS, Array, dot, finite
from continuation.correctors import Correction, Corrector
from continuation.evaluation.errors import EvaluationError
from continuation.metric import inner
from continuation.point.linearization import REFINED, Linearization, generic, linearize, relinearize
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection

LOW_ORDER_FRACTION = 0.9
"""Part of the distance to the boundary for a prediction, as in interior methods (Wright, Primal-Dual Interior-Point
Methods, 1997)."""

SHORTENINGS, SHORTEST = 60, 0.1
"""Limit of cuts at a boundary, below any least step, and least factor of one."""


@frozen(eq=False)
class Arrival:
    """An attempt that reached the path; `angle`: between the tangents, radians."""

    h: float
    correction: Correction
    point: Linearization
    angle: float


Attempt: TypeAlias = Arrival | Rejected


@frozen(eq=False)
class Stepper:
    """Makes attempts."""

    solver: PathSolver
    corrector: Corrector
    fraction: float

    def shortened(self, point: Linearization, prediction: Prediction, h: float) -> float:
        """The step, cut until the prediction is well inside the domain."""
        max_step = self.solver.max_step
        if max_step is None:
            return h
        for _ in range(SHORTENINGS):
            room = self.fraction * max_step(point.u, prediction(h) - point.u)
            if room >= 1.0:
                return h
            h *= max(room, SHORTEST)
        return h

    def attempt(self, point: Linearization, prediction: Prediction, h: float) -> Attempt:
        """Try a step of length h."""
        try:
            predicted = prediction(h)
        except EvaluationError as error:
            return Rejected(h, error.rejection, str(error))
        if not finite(predicted):
            return Rejected(h, Rejection.OVERFLOW)
        solver, border = self.solver, point.border
        correction = self.corrector.correct(solver.evaluator, point, predicted, border, solver.tolerance)
        rejected = correction.rejected(h)
        if rejected is not None:
            return rejected
        reason = None
        if dot(border, correction.u - point.u) <= 0.0:
            reason = Rejection.BACKWARDS
        # A correction longer than the step left the predicted path.
        elif correction.distance > h:
            reason = Rejection.TOO_FAR
        elif solver.max_step is not None and not solver.max_step(point.u, correction.u - point.u) > 1.0:
            reason = Rejection.OUTSIDE
        if reason is not None:
            return Rejected(h, reason, contraction=correction.contraction)
        return self.arrive(point, border, h, correction)

    def arrive(self, point: Linearization, border: Array, h: float, correction: Correction) -> Attempt:
        """Linearize at the corrected point."""
        evaluator, weights, anchor = self.solver.evaluator, point.weights, correction.anchor
        try:
            if anchor is not None:
                # The tangent is needed to six digits of the tolerance.
                accuracy = max(REFINED, SIX_DIGITS * self.solver.tolerance.relative)
                arrival = relinearize(evaluator, correction.u, weights, anchor, border, accuracy, generic(weights))
            else:
                arrival = linearize(evaluator, correction.u, weights, border)
        except EvaluationError as error:
            return Rejected(h, error.rejection, str(error), correction.contraction)
        cosine = inner(weights, point.tangent, arrival.tangent)
        return Arrival(h, correction, arrival, math.acos(min(max(cosine, -1.0), 1.0)))
