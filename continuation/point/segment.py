"""The path between two accepted points, as a function of t in [0, 1]: cubic Hermite, or the predictor's own series."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from attrs import frozen
from scipy.linalg.blas import daxpy, dscal

from continuation.arrays import Array, add_multiple, dot


class Segment(Protocol):
    """A smooth curve between two accepted points."""

    @property
    def inside(self) -> tuple[float, ...]:
        """Where in (0, 1) to sample it so that no oscillation of it is missed."""
        ...

    def at(self, t: float) -> Array:
        """The point at t in [0, 1], shape (N + 1,)."""
        ...

    def derivative(self, t: float) -> Array:
        """Its derivative with respect to t, shape (N + 1,)."""
        ...

    def sampled(self) -> tuple[Sequence[Array], Sequence[Array]]:
        """Points and derivatives at all of `inside`, each of shape (len(inside), N + 1)."""
        ...

    def until(self, sigma: float, end: Array, v: Array, border: Array) -> Segment:
        """The part up to the point `end` of the path, at pseudo-arclength sigma, where the tangent is v."""
        ...


_QUARTERS = (0.25, 0.5, 0.75)
CUBIC = len(_QUARTERS)
"""How many samples a cubic has; a series has more."""

_T = np.array(_QUARTERS)
_BASIS = np.array(
    [
        [(1.0 - _T) ** 2 * (1.0 + 2.0 * _T), _T**2 * (3.0 - 2.0 * _T), _T * (1.0 - _T) ** 2, _T**2 * (_T - 1.0)],
        [6.0 * _T * (_T - 1.0), 6.0 * _T * (1.0 - _T), (1.0 - _T) * (1.0 - 3.0 * _T), _T * (3.0 * _T - 2.0)],
    ]
).transpose(0, 2, 1)
"""Hermite's basis and its derivative at the quarters: (2, 3, 4)."""


@frozen(eq=False)
class HermiteSegment:
    """The cubic through two points with given derivatives with respect to t."""

    u0: Array
    u1: Array
    d0: Array
    d1: Array

    @property
    def inside(self) -> tuple[float, ...]:
        """Quarters: the derivative of a cubic changes sign twice at most."""
        return _QUARTERS

    def at(self, t: float) -> Array:
        """The cubic at t."""
        # From the beginning, so that round-off is that of the way, not of a sum of large parts.
        s, onward = t * (1.0 - t), self.u1 - self.u0
        dscal(t * t * (3.0 - 2.0 * t), onward)
        point: Array = self.u0 + daxpy(self.d1, daxpy(self.d0, onward, onward.size, s * (1.0 - t)), onward.size, -s * t)
        return point

    def derivative(self, t: float) -> Array:
        """Its derivative at t."""
        slope = self.u1 - self.u0
        dscal(6.0 * t * (1.0 - t), slope)
        return add_multiple(add_multiple(slope, (1.0 - t) * (1.0 - 3.0 * t), self.d0), t * (3.0 * t - 2.0), self.d1)

    def coordinate(self, i: int) -> tuple[Callable[[float], float], Callable[[float], float]]:
        """One coordinate as a function of t, and its derivative: in a tenth of the time that all of them take."""
        begin, before, after = self.u0.item(i), self.d0.item(i), self.d1.item(i)
        onward = self.u1.item(i) - begin

        def at(t: float) -> float:
            s = 1.0 - t
            return begin + t * (t * (3.0 - 2.0 * t) * onward + s * (s * before - t * after))

        def slope(t: float) -> float:
            s = 1.0 - t
            return 6.0 * t * s * onward + s * (1.0 - 3.0 * t) * before + t * (3.0 * t - 2.0) * after

        return at, slope

    def sampled(self) -> tuple[Sequence[Array], Sequence[Array]]:
        """All at once: a product of matrices costs less than one point by itself."""
        points, slopes = _BASIS @ np.array([self.u0, self.u1, self.d0, self.d1])
        return points, slopes

    def until(self, sigma: float, end: Array, v: Array, border: Array) -> Segment:
        """The cubic to the new end."""
        return hermite(self.u0, self.d0, end, v, border)


_HIGHER = np.array(
    [
        [(_T * (1.0 - _T)) ** 2, (_T * (1.0 - _T)) ** 2 * _T],
        [2.0 * _T * (1.0 - _T) * (1.0 - 2.0 * _T), _T**2 * (1.0 - _T) * (3.0 - 5.0 * _T)],
    ]
).transpose(0, 2, 1)
"""The same of what a quintic adds: s^2 and s^2 t, with s = t (1 - t), and their derivatives: (2, 3, 2)."""


@frozen(eq=False)
class QuinticSegment:
    """A cubic and s^2 (c + d t), s = t (1 - t), which leaves the ends and the tangents there as they are."""

    cubic: HermiteSegment
    c: Array
    d: Array

    @property
    def inside(self) -> tuple[float, ...]:
        """Where the cubic is sampled."""
        return self.cubic.inside

    def at(self, t: float) -> Array:
        """The point at t."""
        s = t * (1.0 - t)
        return add_multiple(self.cubic.at(t), s * s, self.c + t * self.d)

    def derivative(self, t: float) -> Array:
        """Its derivative at t."""
        s = t * (1.0 - t)
        slope = add_multiple(self.cubic.derivative(t), 2.0 * s * (1.0 - 2.0 * t), self.c + t * self.d)
        return add_multiple(slope, s * s, self.d)

    def coordinate(self, i: int) -> tuple[Callable[[float], float], Callable[[float], float]]:
        """One coordinate as a function of t, and its derivative."""
        (at, slope), c, d = self.cubic.coordinate(i), self.c.item(i), self.d.item(i)

        def higher(t: float) -> float:
            s = t * (1.0 - t)
            return at(t) + s * s * (c + t * d)

        def steeper(t: float) -> float:
            s = t * (1.0 - t)
            return slope(t) + s * (2.0 * (1.0 - 2.0 * t) * (c + t * d) + s * d)

        return higher, steeper

    def sampled(self) -> tuple[Sequence[Array], Sequence[Array]]:
        """All at once."""
        (points, slopes), (more, steeper) = self.cubic.sampled(), _HIGHER @ np.array([self.c, self.d])
        return points + more, slopes + steeper

    def until(self, sigma: float, end: Array, v: Array, border: Array) -> Segment:
        """The cubic to the new end."""
        return self.cubic.until(sigma, end, v, border)


_SIXTEENTHS = tuple(k / 16 for k in range(1, 16))


class Curve(Protocol):
    """A series in pseudo-arclength, trusted up to `reach`."""

    @property
    def reach(self) -> float:
        """The longest step for which it is trusted."""
        ...

    def __call__(self, h: float) -> Array:
        """The point at h."""
        ...

    def derivative(self, h: float) -> Array:
        """du/dh."""
        ...


@frozen(eq=False)
class SeriesSegment:
    """The path between two accepted points by a series at the first, made to end on the second.

    What the series leaves at the end is its first neglected term, so it is restored as t^power times the gap, which is
    worth one more order in between.
    """

    curve: Curve
    length: float
    gap: Array
    power: int

    @property
    def inside(self) -> tuple[float, ...]:
        """Sixteenths: a series may turn several times within its range."""
        return _SIXTEENTHS

    def at(self, t: float) -> Array:
        """The point at t."""
        point: Array = self.curve(t * self.length) + t**self.power * self.gap
        return point

    def derivative(self, t: float) -> Array:
        """Its derivative at t."""
        slope: Array = self.length * self.curve.derivative(t * self.length)
        return slope + self.power * t ** (self.power - 1) * self.gap

    def sampled(self) -> tuple[Sequence[Array], Sequence[Array]]:
        """One by one."""
        return [self.at(t) for t in _SIXTEENTHS], [self.derivative(t) for t in _SIXTEENTHS]

    def until(self, sigma: float, end: Array, v: Array, border: Array) -> Segment:
        """The same series to the new end."""
        return SeriesSegment(self.curve, sigma, end - self.curve(sigma), self.power)


def hermite(u0: Array, v0: Array, u1: Array, v1: Array, border: Array) -> HermiteSegment:
    """The Hermite segment in the pseudo-arclength parameter sigma = border . (u - u0), rescaled to [0, 1].

    The derivative of the path with respect to sigma is v / (border . v), which needs no estimate of the arclength.
    """
    sigma = dot(border, u1 - u0)
    return HermiteSegment(u0, u1, v0 * (sigma / dot(border, v0)), v1 * (sigma / dot(border, v1)))


_NODES, _WEIGHTS = (tuple(map(float, values)) for values in np.polynomial.legendre.leggauss(8))
"""Gauss' rule on [-1, 1]: its nodes are eigenvalues, not to be computed for every point."""


def parameter_at(segment: Segment, weights: Array, fraction: float) -> float:
    """The t at which a fraction of the segment's arclength lies behind.

    The speed is integrated by Gauss' rule on the piece, and t found by Newton's method, which that speed makes
    quadratic; three rounds serve segments that turn by a right angle.
    """
    if fraction <= 0.0 or fraction >= 1.0:
        return min(max(fraction, 0.0), 1.0)

    def speed(t: float) -> float:
        slope = segment.derivative(t)
        return math.sqrt(dot(weights * slope, slope))

    def behind(t: float) -> float:
        return 0.5 * t * sum(b * speed(0.5 * t * (a + 1.0)) for a, b in zip(_NODES, _WEIGHTS))

    goal, t = fraction * behind(1.0), fraction
    for _ in range(5):
        t = min(max(t - (behind(t) - goal) / max(speed(t), 1e-300), 0.0), 1.0)
    return t
