"""Predictors that integrate the Davidenko equation du/ds = v(u), v the unit tangent at u."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import one_of
from continuation.arrays import Array
from continuation.citation.bibliography import HAIRER_NORSETT_WANNER
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import Linearization, linearize
from continuation.predictors.base import Knot, history_in_pseudo_arclength


@frozen(eq=False)
class _Stages:
    """A classical Runge-Kutta step, made anew for each h since its stages depend on it."""

    evaluator: Evaluator
    point: Linearization
    order: int
    reach: float = math.inf

    def _slope(self, u: Array) -> Array:
        # The tangent field exists off the path as well; orientation by angle, since a stage is no point of the path.
        return linearize(self.evaluator, u, self.point.weights, self.point.border).tangent

    def __call__(self, h: float) -> Array:
        """The point after one step of length h."""
        u, k1 = self.point.u, self.point.tangent
        step: Array
        if self.order == 2:
            step = u + h * self._slope(u + 0.5 * h * k1)
            return step
        k2 = self._slope(u + 0.5 * h * k1)
        k3 = self._slope(u + 0.5 * h * k2)
        k4 = self._slope(u + h * k3)
        step = u + (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        return step


@frozen
class RungeKutta:
    """The explicit midpoint rule (order 2) or the classical method (order 4); one factorisation a further stage."""

    references: ClassVar[tuple[str, ...]] = (HAIRER_NORSETT_WANNER,)
    order: int = field(default=4, validator=one_of(2, 4))
    memory: int = field(default=1, init=False)

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> _Stages:
        """A step whose stages are evaluated when its length is known."""
        return _Stages(evaluator, point, self.order)


@frozen(eq=False)
class _Slopes:
    """u + the integral from 0 to h of the polynomial through past tangents."""

    u: Array
    nodes: Array
    slopes: Array
    reach: float = math.inf

    def __call__(self, h: float) -> Array:
        """The integral by Gauss quadrature of sufficient degree: exact for the interpolating polynomial."""
        x, w = np.polynomial.legendre.leggauss(3)
        total = np.zeros_like(self.u)
        for node, weight in zip(0.5 * h * (x + 1.0), 0.5 * h * w):
            for i, slope in enumerate(self.slopes):
                others = np.delete(self.nodes, i)
                total += weight * float(np.prod((node - others) / (self.nodes[i] - others))) * slope
        predicted: Array = self.u + total
        return predicted


@frozen
class AdamsBashforth:
    """The variable-step Adams-Bashforth method on past tangents: order 2 to 4, no evaluation of the homotopy."""

    references: ClassVar[tuple[str, ...]] = (HAIRER_NORSETT_WANNER,)
    order: int = field(default=3, validator=one_of(2, 3, 4))

    @property
    def memory(self) -> int:
        """One past tangent an order."""
        return self.order

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> _Slopes:
        """The integral of the interpolated tangent."""
        nodes, _, slopes = zip(*history_in_pseudo_arclength(point, history))
        return _Slopes(point.u, np.array(nodes), np.array(slopes))
