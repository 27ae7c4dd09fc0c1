"""Taylor predictor: the path's power series from one factorisation.

Asymptotic numerical method (Cochelin, Computers & Structures 53, 1994) in pseudo-arclength.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import ClassVar

import numpy as np
from attrs import field, frozen
from attrs.validators import optional

from continuation.arguments.checks import FRACTION, POSITIVE_FINITE, complain, integer, of_kind
from continuation.arrays import Array
from continuation.citation.bibliography import BAKER_GRAVES_MORRIS, COCHELIN, GRIEWANK_WALTHER
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.homotopy import SupportsTaylor, offers
from continuation.point.linearization import Linearization, factored, with_exact_solves
from continuation.predictors.base import Knot
from continuation.predictors.fitted import fitted
from continuation.predictors.pade import Series, best
from continuation.tolerance import Tolerance

ORDERS = (8, 30)
"""Bounds of the chosen order: beyond 30 round-off removes the gain."""

LARGEST_ORDER = 100
"""The cost is quadratic; orders above 60 gain nothing."""

LONGEST_STEP = 100.0
"""Longest step, in the metric, of a polynomial path, whose last terms vanish."""


def best_order(n: int, accuracy: float) -> int:
    """The order of least work: (f + K) solves a step, steps proportional to accuracy^(1/K).

    f = 4 + n/60 is at most a third slower than the best. (f + K) exp(L/K), L = -ln accuracy, is least at K^2 = L (K +
    f).
    """
    f = 4.0 + n / 60.0
    L = -math.log(accuracy)
    best = 0.5 * (L + math.sqrt(L * L + 4.0 * L * f))
    return min(max(round(best), ORDERS[0]), ORDERS[1])


def series_reach(coefficients: Array, accuracy: float, weights: Array) -> float:
    """The step at which one of the last two terms reaches `accuracy`; the other may vanish by symmetry."""
    measure = Tolerance(relative=accuracy).measure
    order = len(coefficients) - 1
    reach = LONGEST_STEP
    for k in (order - 1, order):
        size = measure(coefficients[k], weights)
        if size > 0.0:
            reach = min(reach, size ** (-1.0 / k))
    return reach


@frozen
class Taylor:
    """Predicts by the path's power series, whose coefficients the homotopy's `taylor` or `continuation.jets` gives.

    Parameters
    ----------
    order : int, optional
        Default: `best_order`.
    accuracy : float
        Size of the series' last terms at the end of a step, in the metric: one corrector step leaves about its square.
        In mid-step the terms are 2^order times smaller.
    safety : float
        Longest step over the range in which the series has this accuracy.
    rational : bool
        Whether to use Pade approximants, whose range is longer and ends before a pole.
    """

    order_wanted: int | None = field(default=None, validator=optional(integer(2, LARGEST_ORDER)), alias="order")
    accuracy: float = field(default=1e-5, validator=FRACTION)
    safety: float = field(default=0.95, validator=POSITIVE_FINITE)
    rational: bool = field(default=False, validator=of_kind("True or False", lambda value: isinstance(value, bool)))
    memory: int = field(default=1, init=False)
    interior_fraction: ClassVar[float] = 0.9999
    """The prediction's error is far below the remaining distance."""

    @property
    def references(self) -> tuple[str, ...]:
        """Series method, and theory of rational curves."""
        return (COCHELIN, BAKER_GRAVES_MORRIS) if self.rational else (COCHELIN,)

    @property
    def order(self) -> int:
        """The given or least order."""
        return self.order_wanted if self.order_wanted is not None else ORDERS[0]

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Series:
        """The series at the point."""
        order = self.order_wanted or best_order(point.u.size, self.accuracy)
        reach = partial(series_reach, accuracy=self.accuracy, weights=point.weights)
        coefficients = self._exact(evaluator, point, order) if evaluator.followed else None
        if coefficients is None:
            evaluator.followed = False
            evaluator.counts.notes.add("series through points of the path, since jets do not follow the residual")
            lately = [knot.arclength for knot in history[-2:]]
            # The metric's unit: a path's length.
            first = 0.5 * (max(lately) - min(lately)) or 1.0
            coefficients = fitted(evaluator, point, order, first, reach, self.accuracy)
        series = Series(coefficients, self.safety * reach(coefficients))
        if not self.rational:
            return series
        rational = best(coefficients, point.weights, self.accuracy, series.reach, self.safety)
        return series if rational is None else rational

    def _exact(self, evaluator: Evaluator, point: Linearization, order: int) -> Array | None:
        try:
            return coefficients_at(evaluator, with_exact_solves(evaluator, point), order)
        except EvaluationError:
            return coefficients_at(evaluator, factored(evaluator, point), order)


def coefficients_at(evaluator: Evaluator, point: Linearization, order: int) -> Array | None:
    """Path coefficients, shape (order + 1, N + 1); None if jets fail."""
    homotopy = evaluator.homotopy
    if offers(homotopy, SupportsTaylor):
        coefficients: Array = homotopy.taylor(point, order)
        if np.shape(coefficients) != (order + 1, point.u.size):
            raise complain(ValueError, "taylor", f"an array of shape {order + 1, point.u.size}", coefficients)
    else:
        from continuation import jets

        try:
            coefficients = jets.path_series(evaluator.called, point.u, point.tangent, point.solve, order)
        except (TypeError, AttributeError, ValueError):
            return None
        evaluator.methods.add(GRIEWANK_WALTHER)
    if not np.isfinite(coefficients.sum()):
        raise EvaluationError("the Taylor coefficients are not finite")
    return coefficients
