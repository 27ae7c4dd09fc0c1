"""The path between two accepted points as a function of t in [0, 1]."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from attrs import frozen

from continuation.arrays import Array, dot


class Segment(Protocol):
    """A smooth curve between two accepted points."""

    @property
    def inside(self) -> tuple[float, ...]:
        """Places in (0, 1) that miss no oscillation."""
        ...

    def at(self, t: float) -> Array:
        """The point, shape (N + 1,)."""
        ...

    def derivative(self, t: float) -> Array:
        """Derivative in t, shape (N + 1,)."""
        ...


_QUARTERS = (0.25, 0.5, 0.75)
CUBIC = len(_QUARTERS)
"""Samples of a cubic; a series has more."""

_POWERS = np.arange(1.0, 6.0)


def _powers(t: Any) -> tuple[Array, Array]:
    """Powers of t, first to fifth, and their derivatives."""
    return t**_POWERS, _POWERS * t ** (_POWERS - 1.0)


_SAMPLED = _powers(np.array(_QUARTERS)[:, None])
_powers_at = lru_cache(maxsize=16)(_powers)


@frozen(eq=False)
class PolynomialSegment:
    """``begin + c_1 t + c_2 t^2 + ...``; rows of `coefficients` are terms.

    Terms are relative to the beginning, which keeps their digits.
    """

    begin: Array
    coefficients: Array

    @property
    def inside(self) -> tuple[float, ...]:
        """The quarters: a cubic's derivative changes sign at most twice, so no oscillation lies between them."""
        return _QUARTERS

    def at(self, t: float) -> Array:
        """The point at t."""
        point: Array = _powers_at(t)[0][: len(self.coefficients)].dot(self.coefficients)
        point += self.begin
        return point

    def derivative(self, t: float) -> Array:
        """Derivative at t."""
        slope: Array = _powers_at(t)[1][: len(self.coefficients)].dot(self.coefficients)
        return slope

    def sampled(self) -> tuple[Sequence[Array], Sequence[Array]]:
        """Points and derivatives inside."""
        points, slopes = (list(table[:, : len(self.coefficients)] @ self.coefficients) for table in _SAMPLED)
        return [self.begin + point for point in points], slopes

    def bent(self, c: Array, d: Array) -> PolynomialSegment:
        """The cubic plus s^2 (c + d t), s = t (1 - t): ends and tangents stay."""
        first, second, third = self.coefficients
        return PolynomialSegment(self.begin, np.array([first, second + c, third + d - 2.0 * c, c - 2.0 * d, d]))


def cubic(u0: Array, u1: Array, d0: Array, d1: Array) -> PolynomialSegment:
    """The cubic through two points with given derivatives in t."""
    way = u1 - u0
    return PolynomialSegment(u0, np.array([d0, 3.0 * way - 2.0 * d0 - d1, d0 + d1 - 2.0 * way]))


_SIXTEENTHS = tuple(k / 16 for k in range(1, 16))


class Curve(Protocol):
    """A series in pseudo-arclength."""

    @property
    def order(self) -> int:
        """Order of its last term."""
        ...

    def __call__(self, h: float) -> Array:
        """The point at h."""
        ...

    def derivative(self, h: float) -> Array:
        """Derivative du/dh."""
        ...


@frozen(eq=False)
class SeriesSegment:
    """A series at the first point, made to end on the second by adding t^power times the gap there.

    The gap is the first neglected term.
    """

    curve: Curve
    length: float
    gap: Array
    power: int

    @property
    def inside(self) -> tuple[float, ...]:
        """The sixteenths, since a series may turn several times."""
        return _SIXTEENTHS

    def at(self, t: float) -> Array:
        """The point at t."""
        point: Array = self.curve(t * self.length) + t**self.power * self.gap
        return point

    def derivative(self, t: float) -> Array:
        """Derivative at t."""
        slope: Array = self.length * self.curve.derivative(t * self.length)
        return slope + self.power * t ** (self.power - 1) * self.gap

    def until(self, sigma: float, end: Array) -> SeriesSegment:
        """The series up to a new end."""
        return SeriesSegment(self.curve, sigma, end - self.curve(sigma), self.power)


def hermite(u0: Array, v0: Array, u1: Array, v1: Array, border: Array) -> PolynomialSegment:
    """The Hermite cubic in sigma = border . (u - u0), rescaled to [0, 1].

    du/dsigma is v / (border . v).
    """
    sigma = dot(border, u1 - u0)
    return cubic(u0, u1, v0 * (sigma / dot(border, v0)), v1 * (sigma / dot(border, v1)))


_NODES, _WEIGHTS = (tuple(map(float, values)) for values in np.polynomial.legendre.leggauss(8))
"""Gauss' rule on [-1, 1], computed once."""


def parameter_at(segment: Segment, weights: Array, fraction: float) -> float:
    """The t at a fraction of the arclength, by Newton's method on Gauss quadrature."""
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
