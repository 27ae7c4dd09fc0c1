"""The Taylor predictor: the path's own power series, every coefficient from one factorisation.

The asymptotic numerical method (Cochelin, Computers & Structures 53, 1994) in the pseudo-arclength of the current
metric: u(s) with border . (u(s) - u(0)) = s, border = W tangent.
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
from continuation.point.segment import SeriesSegment
from continuation.predictors.base import Knot
from continuation.predictors.fitted import fitted
from continuation.predictors.pade import Pade, best
from continuation.tolerance import Tolerance

ORDERS = (8, 30)
"""Bounds of the orders that the cost model chooses from: beyond 30 round-off in the last terms eats the gain."""

LARGEST_ORDER = 100
"""That may be asked for: a series takes the square of its order, and from about 60 on it gains nothing anywhere."""

LONGEST_STEP = 100.0
"""In the length of the metric: a polynomial path has no last terms that would limit it."""


@frozen(eq=False)
class Series:
    """The truncated series, and the length for which it is trusted."""

    coefficients: Array
    reach: float

    @property
    def order(self) -> int:
        """The order of the last term."""
        return len(self.coefficients) - 1

    def __call__(self, h: float) -> Array:
        """The point at pseudo-arclength h, by Horner's rule."""
        value: Array = self.coefficients[-1].copy()
        for coefficient in self.coefficients[-2::-1]:
            value *= h
            value += coefficient
        return value

    def segment(self, h: float, end: Array) -> SeriesSegment:
        """The path up to the corrected point at pseudo-arclength h."""
        return SeriesSegment(self, h, end - self(h), len(self.coefficients))

    def derivative(self, h: float) -> Array:
        """du/ds at pseudo-arclength h."""
        order = len(self.coefficients) - 1
        value: Array = order * self.coefficients[-1]
        for k in range(order - 1, 0, -1):
            value *= h
            value += k * self.coefficients[k]
        return value


def best_order(n: int, accuracy: float) -> int:
    """The order that minimises work for a length of path: (f + K) solves a step, a step proportional to accuracy^(1/K).

    f is what a factorisation and the rest of a step cost in solves; 4 + n/60 is a compromise between dense matrices of
    order n, where it grows, and the n times smaller systems of plug-ins, where it does not: the order chosen takes at
    most a third more time than the best one measured (docs, "choosing"). Setting the derivative of (f + K) exp(L/K),
    L = -ln accuracy, to zero gives K^2 = L (K + f).
    """
    f = 4.0 + n / 60.0
    L = -math.log(accuracy)
    best = 0.5 * (L + math.sqrt(L * L + 4.0 * L * f))
    return min(max(round(best), ORDERS[0]), ORDERS[1])


def series_reach(coefficients: Array, accuracy: float, weights: Array) -> float:
    """The step at which the last two terms reach `accuracy`, relative to the point's components (a mixed measure).

    Two terms, since one may vanish by symmetry; the shorter answer counts.
    """
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
    """Series prediction of any order, with the plug-in's own coefficients or those of `continuation.jets`.

    Parameters
    ----------
    order : int, optional
        Chosen by `best_order` where not given.
    accuracy : float
        Size of the last terms, relative to the components of the point, at the end of a step. The corrector's first
        increment brings an error of this size to its square, so that it need not be the tolerance of the trace; the
        dense output between points has about this accuracy times 2^-order in the middle of a step.
    safety : float
        Factor on the reach.
    rational : bool
        Pade approximants with a common denominator: a larger range, ended before a pole.
    """

    order_wanted: int | None = field(default=None, validator=optional(integer(2, LARGEST_ORDER)), alias="order")
    accuracy: float = field(default=1e-5, validator=FRACTION)
    safety: float = field(default=0.95, validator=POSITIVE_FINITE)
    rational: bool = field(default=False, validator=of_kind("True or False", lambda value: isinstance(value, bool)))
    memory: int = field(default=1, init=False)
    interior_fraction: ClassVar[float] = 0.9999
    """How much of the way to the boundary of a domain it may go: its error is far below the distance that is left."""

    @property
    def references(self) -> tuple[str, ...]:
        """The series method and, for rational curves, their theory."""
        return (COCHELIN, BAKER_GRAVES_MORRIS) if self.rational else (COCHELIN,)

    @property
    def order(self) -> int:
        """The order given, or the least that is chosen; `Series.order` is the one that was."""
        return self.order_wanted if self.order_wanted is not None else ORDERS[0]

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Series | Pade:
        """The coefficients at the point, with the factorisation at hand."""
        order = self.order_wanted or best_order(point.u.size, self.accuracy)
        coefficients = self._exact(evaluator, point, order) if evaluator.followed else None
        if coefficients is None:
            evaluator.followed = False
            evaluator.counts.notes.add("series through points of the path, since jets do not follow the residual")
            lately = [knot.arclength for knot in history[-2:]]
            # One is the metric's unit: about how far a path goes.
            first = 0.5 * (max(lately) - min(lately)) or 1.0
            coefficients = fitted(evaluator, point, order, first, partial(self._reach, point), self.accuracy)
        series = Series(coefficients, self.safety * self._reach(point, coefficients))
        if not self.rational:
            return series
        rational = best(coefficients, point.weights, self.accuracy, series.reach, self.safety)
        return series if rational is None else rational

    def _reach(self, point: Linearization, coefficients: Array) -> float:
        return series_reach(coefficients, self.accuracy, point.weights)

    def _exact(self, evaluator: Evaluator, point: Linearization, order: int) -> Array | None:
        try:
            return coefficients_at(evaluator, with_exact_solves(evaluator, point), order)
        except EvaluationError:
            return coefficients_at(evaluator, factored(evaluator, point), order)


def coefficients_at(evaluator: Evaluator, point: Linearization, order: int) -> Array | None:
    """Coefficients of the path at a point, shape (order + 1, N + 1); None where jets do not follow the residual."""
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
