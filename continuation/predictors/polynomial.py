"""Predictors from past points and tangents."""

from __future__ import annotations

import math
from collections.abc import Sequence

from attrs import field, frozen
from scipy.linalg.blas import dscal

from continuation.arrays import Array, dot, multiple
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import Linearization
from continuation.predictors.base import Knot


@frozen(eq=False)
class Line:
    """u + h v."""

    u: Array
    v: Array
    reach: float = math.inf

    def __call__(self, h: float) -> Array:
        """The point at h."""
        point = multiple(h, self.v)
        point += self.u
        return point


@frozen(eq=False)
class Cubic:
    """u + h (v + h (square + (h - sigma) cube))."""

    u: Array
    v: Array
    square: Array
    cube: Array
    sigma: float
    reach: float = math.inf

    def __call__(self, h: float) -> Array:
        """The point at h."""
        point = multiple(h - self.sigma, self.cube)
        for coefficient in (self.square, self.v):
            point += coefficient
            dscal(h, point)
        point += self.u
        return point


@frozen
class Tangent:
    """Euler's predictor, u + h v."""

    memory: int = field(default=1, init=False)
    order: int = field(default=1, init=False)

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Line:
        """The tangent line."""
        return Line(point.u, point.tangent)


@frozen
class Hermite:
    """The cubic through the last two points and tangents, in sigma = border . (u - point.u): order 3.

    It is Euler's at the start, and after a turn of 90 degrees or more.
    """

    memory: int = field(default=2, init=False)
    order: int = field(default=3, init=False)

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Cubic | Line:
        """The Hermite cubic."""
        u, v, past = point.u, point.tangent, history[-min(len(history), 2)]
        sigma, along = dot(point.border, past.u - u), dot(point.border, past.tangent)
        if not (sigma < 0.0 and along > 0.0):
            return Line(u, v)
        chord = (past.u - u) / sigma
        square = (chord - v) / sigma
        return Cubic(u, v, square, ((past.tangent / along - chord) / sigma - square) / sigma, sigma)
