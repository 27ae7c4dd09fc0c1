"""One attempt at a step: predict, correct, linearize, and measure how far the path turned."""

from __future__ import annotations

import math
from typing import TypeAlias

from attrs import frozen

from continuation.arrays import Array, dot, finite
from continuation.correctors import Correction, Corrector
from continuation.evaluation.errors import EvaluationError
from continuation.metric import inner
from continuation.point.linearization import REFINED, Linearization, linearize, relinearize
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection

LOW_ORDER_FRACTION = 0.9
"""How much of the way to the boundary a prediction may go: the usual fraction of interior methods (Wright, Primal-Dual
Interior-Point Methods, 1997), for a prediction whose error may be as large as its distance to the boundary."""

SHORTENINGS, SHORTEST = 60, 0.1
"""How often a curved prediction is cut on its way to the boundary, and the least factor of a cut: sixty of these are
shorter than any floor."""

TANGENT = 1e-6
"""How accurate a step's tangent has to be, in units of the relative tolerance: refining further buys nothing."""


@frozen(eq=False)
class Arrival:
    """An attempt that arrived on the path.

    `h`: Its step length. `point`: Where it arrived; the tangent is oriented by angle for now. `angle`: Between the
    tangents, radians.
    """

    h: float
    correction: Correction
    point: Linearization
    angle: float


Attempt: TypeAlias = Arrival | Rejected


@frozen(eq=False)
class Stepper:
    """The parts that an attempt needs."""

    solver: PathSolver
    corrector: Corrector
    fraction: float

    def shortened(self, point: Linearization, prediction: Prediction, h: float) -> float:
        """The step, cut until the predicted point of an interior homotopy is well inside."""
        max_step = self.solver.max_step
        if max_step is None:
            return h
        for _ in range(SHORTENINGS):
            room = self.fraction * max_step(point.u, prediction(h) - point.u)
            if room >= 1.0:
                return h
            # For a straight prediction this is exact; a curved one may need another turn of the loop.
            h *= max(room, SHORTEST)
        return h

    def attempt(self, point: Linearization, prediction: Prediction, h: float) -> Attempt:
        """A regular attempt with step length h."""
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
        # Whatever the controller looks at: a correction longer than the step has left the path that was predicted.
        elif correction.distance > h:
            reason = Rejection.TOO_FAR
        elif solver.max_step is not None and not solver.max_step(point.u, correction.u - point.u) > 1.0:
            reason = Rejection.OUTSIDE
        if reason is not None:
            return Rejected(h, reason, contraction=correction.contraction)
        return self.arrive(point, border, h, correction)

    def arrive(self, point: Linearization, border: Array, h: float, correction: Correction) -> Attempt:
        """Linearize at the corrected point and measure the angle."""
        evaluator, weights, anchor = self.solver.evaluator, point.weights, correction.anchor
        try:
            if anchor is not None:
                accuracy = max(REFINED, TANGENT * self.solver.tolerance.relative)
                arrival = relinearize(evaluator, correction.u, weights, anchor, border, True, accuracy)
            else:
                arrival = linearize(evaluator, correction.u, weights, border)
        except EvaluationError as error:
            return Rejected(h, error.rejection, str(error), correction.contraction)
        # Both are of unit length in this metric.
        cosine = inner(weights, point.tangent, arrival.tangent)
        return Arrival(h, correction, arrival, math.acos(min(max(cosine, -1.0), 1.0)))
