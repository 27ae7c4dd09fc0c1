"""The corrector protocol and common loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from attrs import define, frozen

from continuation.arrays import ROOT_OF_ROUND_OFF, Array, largest
from continuation.contraction import HALVING, Contraction, Iteration
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import INVERTIBLE, norm
from continuation.point.linearization import Anchor, Linearization
from continuation.rejection import Rejected, Rejection
from continuation.tolerance import LEAST_TOLERANCE, Tolerance


@frozen(eq=False)
class Correction:
    """Result of a correction.

    Attributes
    ----------
    u : ndarray, shape (N + 1,)
        Corrected point or last iterate.
    iterations : int
        Increments.
    residual_norm : float
        Largest component of H(u), or nan.
    contraction : float
        Largest ratio of increments; 0 for one.
    distance : float
        From the prediction, in the metric.
    rejection : Rejection or None
        Reason of a failure.
    detail : str
    anchor : Anchor or None
        Last factorisation, for the tangent.
    """

    u: Array
    iterations: int
    residual_norm: float
    contraction: float
    distance: float
    rejection: Rejection | None = None
    detail: str = ""
    anchor: Anchor | None = None

    @property
    def converged(self) -> bool:
        """Whether u is on the path."""
        return self.rejection is None

    def rejected(self, h: float) -> Rejected | None:
        """Failure of a step of length h, or None.

        Parameters
        ----------
        h : float
        """
        return None if self.rejection is None else Rejected(h, self.rejection, self.detail, self.contraction)


class Corrector(Protocol):
    """Moves a predicted point onto the path."""

    def correct(
        self, evaluator: Evaluator, point: Linearization, predicted: Array, border: Array, tolerance: Tolerance
    ) -> Correction:
        """Solve H(u) = 0 from `predicted`.

        Parameters
        ----------
        evaluator : Evaluator
        point : Linearization
            Last accepted point.
        predicted : ndarray, shape (N + 1,)
        border : ndarray, shape (N + 1,)
            Keller's correctors keep border . (u - predicted) = 0.
        tolerance : Tolerance
        """
        ...


POLISHING = Contraction()
"""Chord steps from the tolerance to round-off."""

RESIDUAL_NOISE = 32.0
"""Largest round-off residual, in units of `Evaluator.round_off`: H sums many terms."""


FAR_FROM_ROUND_OFF = RESIDUAL_NOISE * RESIDUAL_NOISE
"""A residual so large deserves a factorisation."""


def far_from_round_off(evaluator: Evaluator, u: Array) -> bool:
    """Whether a residual is far above round-off."""
    r = evaluator.residual(u)
    return largest(r / np.maximum(evaluator.round_off(u, r), INVERTIBLE**2)) > FAR_FROM_ROUND_OFF


def holds(evaluator: Evaluator, u: Array) -> bool:
    """Whether H vanishes at a point where Newton's increment is small: the residual is round-off, or noise that the
    increment halves.
    """
    if not far_from_round_off(evaluator, u):
        return True
    apply = evaluator.differential(u)
    if apply is None:
        return False
    r = evaluator.residual(u)
    z = evaluator.factor(u, np.append(np.zeros(u.size - 1), 1.0)).solve(-r, 0.0)
    return largest(apply(z) + r) <= HALVING * largest(r)


SAME_TERMS = 0.1
"""A component that changes by less keeps its round-off."""


@define(eq=False)
class _Terms:
    """Noise level of H, sampled twice where it matters."""

    evaluator: Evaluator
    u: Array
    residual: Array
    terms: Array
    twice: bool
    least: Array

    def level(self, r: Array, most: float = np.inf) -> float:
        """The residual relative to noise; above `most` without a second sample."""
        found = largest(r / self.terms)
        if not self.twice and RESIDUAL_NOISE < found <= most:
            self.twice = True
            self.terms = np.maximum(self.terms, self.evaluator.look(self.u, self.residual, -1, self.least))
            found = largest(r / self.terms)
        return found


Direction = Callable[[int, Array, Array, float], Array]
"""Increment from iteration, u, residual and contraction so far."""


def iterate(
    evaluator: Evaluator,
    point: Linearization,
    predicted: Array,
    tolerance: Tolerance,
    direction: Direction,
    max_iterations: int,
    max_contraction: float,
    anchors: Sequence[Anchor] = (),
) -> Correction:
    """Add increments until one is small and the residual agrees, or they stop shrinking.

    A ratio above `max_contraction` ends the iteration: wandering correctors find other branches. Near the tolerance,
    where round-off spoils ratios, only the limit of iterations counts. `direction` appends factorisations to `anchors`.
    """
    iteration, weights = Iteration(predicted, Contraction(max_iterations, max_contraction, noise=1.0)), point.weights
    r, found, done = predicted, False, False
    rejection: Rejection | None = None
    detail, count, worst = "", 0, 0.0
    try:
        r = evaluator.residual(predicted)
        while not done and iteration.count < max_iterations:
            step = direction(iteration.count, iteration.x, r, iteration.worst)
            size = norm(weights, step) / tolerance.relative
            if not iteration.add(step, size):
                break
            r, found = evaluator.residual(iteration.x), True
            done = size <= 1.0 and largest(r) <= tolerance.residual
        count, worst = iteration.count, iteration.worst
        # Newton's error is the increment squared: tolerances below this demand residuals at round-off.
        if done and tolerance.relative <= ROOT_OF_ROUND_OFF:
            # Polish until the residual is round-off: an increment may be large for a small component.
            before, least = np.inf, LEAST_TOLERANCE / np.sqrt(weights)
            for fresh in range(POLISHING.iterations):
                u = iteration.x
                terms = evaluator.round_off(u, r, least) if fresh else evaluator.look(u, r, 1, least)
                beside = _Terms(evaluator, u, r, np.maximum(terms, INVERTIBLE**2), twice=fresh > 0, least=least)
                # Residuals far from round-off need no second sample.
                left = beside.level(r, FAR_FROM_ROUND_OFF)
                if left <= (FAR_FROM_ROUND_OFF if fresh else RESIDUAL_NOISE) or left > before:
                    break
                before = left if fresh else np.inf
                k, ratio = (count + 2 * fresh, 1.0) if fresh else (count, worst)
                iteration = Iteration(u, POLISHING)
                while left > RESIDUAL_NOISE and iteration.count < POLISHING.iterations:
                    if not iteration.add(direction(k, iteration.x, r, ratio), left):
                        break
                    r = evaluator.residual(iteration.x)
                    left = beside.level(r)
                if left <= RESIDUAL_NOISE and (np.abs(iteration.x - u) <= SAME_TERMS * np.abs(u)).all():
                    break
        elif iteration.stalled:
            rejection, detail = Rejection.NOT_CONTRACTING, f"ratio {iteration.ratio:.2g}"
        elif not done:
            rejection, detail = Rejection.NOT_CONVERGED, f"{max_iterations} iterations"
    except EvaluationError as error:
        rejection, detail = error.rejection, str(error)
    u, anchor = iteration.x, anchors[-1] if anchors else None
    distance, residual_norm = norm(weights, u - predicted), largest(r) if found else np.nan
    return Correction(u, count, residual_norm, worst, distance, rejection, detail, anchor)
