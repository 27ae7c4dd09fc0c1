"""Polynomial predictors through past points and tangents, without evaluations."""

from __future__ import annotations

import math
from collections.abc import Sequence

from attrs import field, frozen
from scipy.linalg.blas import dscal

from continuation.arguments.checks import integer
from continuation.arrays import Array, dot, multiple
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import Linearization
from continuation.predictors.base import Knot, history_in_pseudo_arclength


@frozen(eq=False)
class Interpolant:
    """Newton form of a polynomial through the current point (h = 0) and past data."""

    nodes: Sequence[float]
    coefficients: Sequence[Array]
    reach: float = math.inf

    def __call__(self, h: float) -> Array:
        """Evaluate by Horner's scheme."""
        value: Array = self.coefficients[-1].copy()
        for node, coefficient in zip(self.nodes[-2::-1], self.coefficients[-2::-1]):
            dscal(h - node, value)
            value += coefficient
        return value


def interpolate(nodes: Sequence[float], values: Sequence[Array], slopes: Sequence[Array | None]) -> Interpolant:
    """Divided differences for Hermite data; a node with a slope counts twice.

    Nodes may come in any order, but a repeated node must follow its twin, which is how they are laid out here. For the
    cubic between two points on [0, 1] `point.segment.cubic` is the same polynomial in the form that all its
    samples come from one product of matrices.
    """
    z: list[float] = []
    table: list[Array] = []
    first: list[Array | None] = []
    for node, value, slope in zip(nodes, values, slopes):
        for copy in range(1 if slope is None else 2):
            z.append(node)
            table.append(value)
            first.append(slope if copy else None)
    coefficients = [table[0]]
    for level in range(1, len(z)):
        following = []
        for i in range(len(z) - level):
            slope = first[i + 1]
            if level == 1 and slope is not None:
                following.append(slope)
            else:
                following.append((table[i + 1] - table[i]) / (z[i + level] - z[i]))
        table = following
        coefficients.append(table[0])
    return Interpolant(z, coefficients)


@frozen(eq=False)
class Line:
    """u + h v."""

    u: Array
    v: Array
    reach: float = math.inf

    def __call__(self, h: float) -> Array:
        """Return the point at h."""
        point = multiple(h, self.v)
        point += self.u
        return point


@frozen
class Tangent:
    """Euler's predictor, u + h v."""

    memory: int = field(default=1, init=False)
    order: int = field(default=1, init=False)

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Line:
        """Return the tangent line."""
        return Line(point.u, point.tangent)


@frozen
class Secant:
    """The line through the last two points; the tangent at the start."""

    memory: int = field(default=2, init=False)
    order: int = field(default=1, init=False)

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Line:
        """Return the secant line, with unit speed in the point's metric."""
        knots = history_in_pseudo_arclength(point, history)
        if len(knots) < 2:
            return Line(point.u, point.tangent)
        sigma, past, _ = knots[1]
        return Line(point.u, (past - point.u) / sigma)


@frozen
class Hermite:
    """The cubic through the last two points and tangents; Euler's step at the start. Order 3, at no extra cost."""

    memory: int = field(default=2, init=False)
    order: int = field(default=3, init=False)

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Interpolant | Line:
        """Return the Hermite cubic."""
        knots = history_in_pseudo_arclength(point, history)
        if len(knots) < 2:
            return Line(point.u, point.tangent)
        # `interpolate`, written out for speed.
        (_, u, v), (sigma, past, slope) = knots[:2]
        chord = (past - u) / sigma
        square = (chord - v) / sigma
        cube = ((slope - chord) / sigma - square) / sigma
        return Interpolant((0.0, 0.0, sigma, sigma), (u, v, square, cube))


MOST_POINTS = 50
"""More points would be slower than the step: time is their square."""


@frozen
class Polynomial:
    """A polynomial of up to `degree` through past points, with the current tangent.

    It ends before Newton terms that do not decrease: high degrees fail on rough histories.
    """

    degree: int = field(default=4, validator=integer(2, MOST_POINTS))

    @property
    def memory(self) -> int:
        """The tangent counts as one condition."""
        return self.degree

    @property
    def order(self) -> int:
        """The highest order used."""
        return self.degree

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Interpolant | Line:
        """Return the interpolant of the chosen degree."""
        knots = history_in_pseudo_arclength(point, history)
        if len(knots) < 2:
            return Line(point.u, point.tangent)
        nodes, values, slopes = zip(*knots)
        full = interpolate(nodes, values, [slopes[0], *(None for _ in nodes[1:])])
        keep = _falling(full, -nodes[1], point.weights)
        return Interpolant(full.nodes[:keep], full.coefficients[:keep])


def _falling(full: Interpolant, step: float, weights: Array) -> int:
    """Number of Newton terms before one that does not decrease."""
    factor, previous = 1.0, math.inf
    for k, coefficient in enumerate(full.coefficients):
        if k:
            factor *= abs(step - full.nodes[k - 1])
        size = factor * math.sqrt(dot(weights * coefficient, coefficient))
        if k > 1 and size >= previous:
            return k
        previous = size if k else math.inf
    return len(full.coefficients)
