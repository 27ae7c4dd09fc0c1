"""What a corrector is, and the loop that all of them share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Protocol

import numpy as np
from attrs import define, frozen

from continuation.arrays import Array, largest
from continuation.contraction import Contraction, Iteration
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import norm
from continuation.point.linearization import Anchor, Linearization
from continuation.rejection import Rejected, Rejection
from continuation.tolerance import LEAST_TOLERANCE, Tolerance


@frozen(eq=False)
class Correction:
    """The outcome of a correction.

    Attributes
    ----------
    u : ndarray, shape (N + 1,)
        The corrected point (the last iterate where it failed).
    iterations : int
        Increments computed.
    residual_norm : float
        Largest component of the residual at u; nan where it failed before one was evaluated.
    contraction : float
        Largest ratio of successive increments seen; 0 with a single increment.
    distance : float
        Length of u minus the predicted point in the metric.
    rejection : Rejection or None
        Why it failed; None where it converged.
    detail : str
        What is particular to this failure.
    anchor : Anchor or None
        The last factorisation made on the way, which may serve the tangent too.
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
        """The failure as that of an attempt with step length h; None where it converged.

        Parameters
        ----------
        h : float

        Returns
        -------
        Rejected or None
        """
        return None if self.rejection is None else Rejected(h, self.rejection, self.detail, self.contraction)


class Corrector(Protocol):
    """A way back to the path from a predicted point."""

    def correct(
        self, evaluator: Evaluator, point: Linearization, predicted: Array, border: Array, tolerance: Tolerance
    ) -> Correction:
        """Solve H(u) = 0 from `predicted`.

        Parameters
        ----------
        evaluator : Evaluator
        point : Linearization
            The last accepted point, whose factorisation may serve.
        predicted : ndarray, shape (N + 1,)
        border : ndarray, shape (N + 1,)
            The direction that correctors of Keller's kind keep fixed: border . (u - predicted) = 0.
        tolerance : Tolerance
        """
        ...


ROOT_OF_ROUND_OFF = float(np.finfo(float).eps) ** 0.5
"""A tolerance below this asks for a residual at round-off: Newton's last error is about the square of its increment."""

TINY = 1e-300
"""Stands for terms that do not move: no residual beside them is round-off."""

POLISHING = Contraction(iterations=12)
"""From the tolerance to round-off chord steps that halve an increment, or better, need no more."""

RESIDUAL_NOISE = 32.0
"""How much larger than what `Evaluator.round_off` sees a residual at round-off may be: it looks once, at something
random, and H adds up as many terms as it has."""


FAR_FROM_ROUND_OFF = 30.0 * RESIDUAL_NOISE
"""A residual this large after polishing is worth a factorisation of its own."""

POLISHING_ROUNDS = 10
"""At most so many, while they help: near a pole Newton's method first creeps."""


def level(r: Array, terms: Array) -> float:
    """The largest component of a residual beside the round-off of its terms, as `Evaluator.round_off` sees it."""
    return largest(r / np.maximum(terms, TINY))


def far_from_round_off(evaluator: Evaluator, u: Array) -> bool:
    """Whether a component of the residual at u is far above the round-off of what that equation is made of."""
    r = evaluator.residual(u)
    return level(r, evaluator.round_off(u, r)) > FAR_FROM_ROUND_OFF


INCREMENT_LEAVES = 0.5
"""The part of a residual that an increment may leave in the linear equations: one that leaves more solves nothing."""


def holds(evaluator: Evaluator, u: Array) -> bool:
    """Whether a point at which Newton's increment is small is a zero of H.

    Either the residual is round-off, or (where it is noise of another kind) the increment does solve its equations.
    """
    if not far_from_round_off(evaluator, u):
        return True
    apply = evaluator.differential(u)
    if apply is None:
        return False
    r = evaluator.residual(u)
    z = evaluator.factor(u, np.append(np.zeros(u.size - 1), 1.0)).solve(-r, 0.0)
    return largest(apply(z) + r) <= INCREMENT_LEAVES * largest(r)


SAME_TERMS = 0.1
"""A component that changed by less than this part of it leaves the round-off of its terms what it was, about."""


def _alike(u: Array, v: Array) -> bool:
    return bool((np.abs(u - v) <= SAME_TERMS * np.abs(u)).all())


@define(eq=False)
class _Terms:
    """What round-off makes of the terms of H at a point: seen in one direction, in two where that might matter."""

    evaluator: Evaluator
    u: Array
    residual: Array
    terms: Array
    twice: bool
    least: Array

    def level(self, r: Array, most: float = np.inf) -> float:
        """That of a residual beside them; one above `most`, as one look shows it, needs no second."""
        found = largest(r / self.terms)
        if not self.twice and RESIDUAL_NOISE < found <= most:
            self.twice = True
            self.terms = np.maximum(self.terms, self.evaluator.look(self.u, self.residual, -1, self.least))
            found = largest(r / self.terms)
        return found


@lru_cache(maxsize=8)
def _rule(iterations: int, ratio: float) -> Contraction:
    return Contraction(iterations, ratio, noise=1.0)


Direction = Callable[[int, Array, Array, float], Array]
"""(iteration, u, residual, contraction so far) -> increment."""


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
    """Add increments until one is small and the residual agrees, or until they stop shrinking.

    An increment that grows by more than `max_contraction` ends the iteration: a corrector that wanders finds another
    branch, and a shorter step is cheaper than a lucky one. Near the tolerance round-off makes ratios meaningless, so
    there only the iteration limit counts. `direction` may add the factorisations that it makes to `anchors`: the last
    goes with the outcome.
    """
    iteration, weights = Iteration(predicted, _rule(max_iterations, max_contraction)), point.weights
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
        if done and tolerance.relative <= ROOT_OF_ROUND_OFF:
            # Judged by the residual itself: an increment may be small beside the path and large beside what is left of
            # a component. Where it no longer shrinks that is round-off too, of terms that do not move with u. Rounds
            # after the first have factorisations of their own: the one at hand may be of a point where that component
            # was another.
            before, least = np.inf, LEAST_TOLERANCE / np.sqrt(weights)
            for fresh in range(POLISHING_ROUNDS):
                u = iteration.x
                terms = evaluator.round_off(u, r, least) if fresh else evaluator.look(u, r, 1, least)
                beside = _Terms(evaluator, u, r, np.maximum(terms, TINY), twice=fresh > 0, least=least)
                # What is far from round-off is polished, what is at round-off needs no second look.
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
                if left <= RESIDUAL_NOISE and _alike(u, iteration.x):
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
