"""The path between two accepted points."""

from __future__ import annotations

import math
from typing import Any

from attrs import Factory, field, frozen

from continuation.arrays import Array, dot
from continuation.metric import inner, norm
from continuation.point.linearization import Linearization
from continuation.point.segment import PolynomialSegment, Segment, SeriesSegment, hermite
from continuation.predictors import Prediction


@frozen(eq=False)
class Arc:
    """The path from a to b, in the pseudo-arclength border . (u - a.u).

    `length`: pseudo-arclength of b. `guide`: the segment, or a better model for events.
    """

    a: Linearization
    b: Linearization
    border: Array
    segment: Segment
    length: float = field(default=Factory(lambda arc: position(arc, arc.b.u), takes_self=True), kw_only=True)
    guide: Segment = field(default=Factory(lambda arc: arc.segment, takes_self=True), kw_only=True)
    _samples: list[tuple[Array, Array]] = field(factory=list, init=False)

    @property
    def samples(self) -> list[tuple[Array, Array]]:
        """Points inside the arc, from the guide, with tangents of about unit length."""
        if not self._samples:
            guide = self.guide
            if isinstance(guide, PolynomialSegment):
                found = zip(*guide.sampled())
            else:
                found = zip(map(guide.at, guide.inside), map(guide.derivative, guide.inside))
            self._samples.extend((point, slope / self.length) for point, slope in found)
        return self._samples

    @property
    def just_after_start(self) -> tuple[Array, Array]:
        """A point just after a."""
        return self.guide.at(0.02), self.guide.derivative(0.02) / self.length


def cut(arc: Arc, end: Linearization) -> Arc:
    """Arc up to a point."""
    if isinstance(arc.segment, SeriesSegment):
        return Arc(arc.a, end, arc.border, arc.segment.until(position(arc, end.u), end.u))
    return cubic_between(arc.a, end, arc.border)


def position(arc: Arc, u: Array) -> float:
    """Pseudo-arclength of a point from the arc's beginning."""
    return dot(arc.border, u - arc.a.u)


def arc_between(a: Linearization, b: Linearization, prediction: Prediction) -> Arc:
    """The prediction, bent to end on b, if it is a `Curve`; else the Hermite cubic."""
    # hasattr is faster than isinstance of a Protocol.
    if not hasattr(prediction, "derivative"):
        return cubic_between(a, b, a.border)
    curve: Any = prediction
    h = dot(a.border, b.u - a.u)
    return Arc(a, b, a.border, SeriesSegment(curve, h, b.u - curve(h), curve.order + 1))


def cubic_between(a: Linearization, b: Linearization, border: Array) -> Arc:
    """The Hermite cubic's arc, along `border`."""
    return Arc(a, b, border, hermite(a.u, a.tangent, b.u, b.tangent, border))


def angle_between(a: Linearization, b: Linearization) -> float:
    """Angle between tangents in the metric of a, radians."""
    cosine = inner(a.weights, a.tangent, b.tangent) / norm(a.weights, b.tangent)
    return math.acos(min(max(cosine, -1.0), 1.0))


def length_between(a: Linearization, b: Linearization, angle: float) -> float:
    """Arclength from chord and angle: exact for a circle, else of fourth order."""
    half = 0.5 * angle
    chord = norm(a.weights, b.u - a.u)
    return chord * (half / math.sin(half)) if half > 1e-8 else chord
