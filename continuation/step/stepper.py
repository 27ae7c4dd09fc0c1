"""One attempt at a step: predict, correct, linearize, and measure how far the path turned."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from attrs import frozen

from continuation.arrays import Array, finite
from continuation.correctors import BorderedNewton, Correction, Corrector
from continuation.evaluation.evaluator import EvaluationError, Evaluator, NotFiniteError
from continuation.metric import inner
from continuation.point.linearization import ROUND_OFF, Linearization, linearize, relinearize
from continuation.predictors import Prediction
from continuation.tolerance import Tolerance

MaxStep = Callable[[Array, Array], float]

LOW_ORDER_FRACTION = 0.9
"""How much of the way to the boundary a prediction may go: the usual fraction of interior methods (Wright, Primal-Dual
Interior-Point Methods, 1997), for a prediction whose error may be as large as its distance to the boundary."""


TANGENT = 1e-6
"""How accurate a step's tangent has to be, in units of the relative tolerance: refining further buys nothing."""

LANDING_DISTANCE = 0.3
"""A landing that corrects the prediction by more than this fraction of the step has landed on another branch."""


@frozen(eq=False)
class Attempt:
    """What an attempt found; `arrival` is None where it failed, and `reason` then says why."""

    h: float
    correction: Correction | None
    arrival: Linearization | None
    angle: float
    reason: str = ""
    finite: bool = True
    landed: bool = False


@frozen(eq=False)
class Stepper:
    """The parts that an attempt needs."""

    evaluator: Evaluator
    corrector: Corrector
    tolerance: Tolerance
    max_step: MaxStep | None
    fraction: float

    def shortened(self, point: Linearization, prediction: Prediction, h: float) -> float:
        """The step, cut until the predicted point of an interior homotopy is well inside."""
        if self.max_step is None:
            return h
        for _ in range(60):
            ahead = prediction(h) - point.u
            room = self.fraction * self.max_step(point.u, ahead)
            if room >= 1.0:
                return h
            # For a straight prediction this is exact; a curved one may need another turn of the loop.
            h *= max(room, 0.1)
        return h

    def attempt(self, point: Linearization, prediction: Prediction, h: float) -> Attempt:
        """A regular attempt with step length h."""
        try:
            predicted = prediction(h)
        except EvaluationError as error:
            return Attempt(h, None, None, 0.0, str(error), finite=not isinstance(error, NotFiniteError))
        if not finite(predicted):
            return Attempt(h, None, None, 0.0, "the predicted point is not finite", finite=False)
        border = point.border
        correction = self.corrector.correct(self.evaluator, point, predicted, border, self.tolerance)
        if correction.converged and float(np.dot(border, correction.u - point.u)) <= 0.0:
            return Attempt(h, correction, None, 0.0, "the step went backwards")
        # Whatever the controller looks at: a correction longer than the step has left the path that was predicted.
        if correction.converged and correction.distance > h:
            return Attempt(
                h, correction, None, 0.0, "the corrected point is farther from the prediction than that went"
            )
        if not correction.converged:
            return Attempt(h, correction, None, 0.0, correction.reason, finite=correction.finite)
        if self.max_step is not None and not self.max_step(point.u, correction.u - point.u) > 1.0:
            return Attempt(h, correction, None, 0.0, "the corrected point lies outside the domain")
        return self.arrive(point, border, h, correction)

    def correct_at_target(self, point: Linearization, guess: Array, h: float) -> Attempt:
        """An attempt to end on the target: the parameter of `guess` is kept, the border is e_{N+1}."""
        unit = np.zeros_like(guess)
        unit[-1] = 1.0
        # Newton's method must contract well here: at a fixed parameter a far solution is as good as the path's own.
        newton = BorderedNewton(max_iterations=8, max_contraction=0.3)
        correction = newton.correct(self.evaluator, point, guess, unit, self.tolerance)
        if not correction.converged:
            return Attempt(h, correction, None, 0.0, correction.reason)
        along = float(np.dot(point.border, correction.u - point.u))
        if along <= 0.0 or correction.distance > LANDING_DISTANCE * h:
            return Attempt(h, correction, None, 0.0, "the end found is not where the path was heading")
        # The target may lie on the boundary of the domain, so the end itself is exempt from the ratio test.
        if self.max_step is not None and self.max_step(point.u, correction.u - point.u) < 1.0 - 1e-6:
            return Attempt(h, correction, None, 0.0, "the end lies outside the domain")
        correction.u[-1] = guess[-1]
        return self.arrive(point, point.border, h, correction, landed=True)

    def arrive(
        self, point: Linearization, border: Array, h: float, correction: Correction, landed: bool = False
    ) -> Attempt:
        """Linearize at the corrected point and measure the angle; the tangent is oriented by angle for now."""
        try:
            anchor = correction.anchor
            if anchor is not None:
                accuracy = max(ROUND_OFF, TANGENT * self.tolerance.relative)
                arrival = relinearize(self.evaluator, correction.u, point.weights, anchor, border, True, accuracy)
            else:
                arrival = linearize(self.evaluator, correction.u, point.weights, border, 0)
        except EvaluationError as error:
            return Attempt(h, correction, None, 0.0, str(error))
        cosine = inner(point.weights, point.tangent, arrival.tangent)
        angle = math.acos(min(max(cosine, -1.0), 1.0))
        return Attempt(h, correction, arrival, angle, landed=landed)
