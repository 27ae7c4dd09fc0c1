"""Vector Pade approximants with one denominator: what a truncated series says beyond its circle of convergence."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.point.segment import SeriesSegment
from continuation.tolerance import Tolerance

DEGREES = 6
"""How many successive orders are compared."""

LONGEST_RANGE = 8.0
"""The longest range looked at, in ranges of the series."""

RANGES_LOOKED_AT, BEFORE_POLE = 25, 0.95
"""Places on the way out at which approximants are compared, each a tenth farther than the one before; and how much of
the way to a pole is looked at."""

NUMERICAL_RANK, REAL = 1e-14, 1e-8
"""Singular values, relative, that are round-off; and the imaginary part of a real root: half of the digits."""

HUGE = 1e150
"""The square of a larger number overflows."""


@frozen(eq=False)
class Pade:
    """The rational curve sum_j p_j s^j / sum_i d_i s^i.

    `numerator` of shape (L + 1, N + 1). `denominator`, of shape (m + 1,): Ascending, the first one 1. `order`: Of the
    series that it continues, L + m. `reach`: How far it is trusted.
    """

    numerator: Array
    denominator: Array
    order: int
    reach: float

    def __call__(self, h: float) -> Array:
        """The point at pseudo-arclength h."""
        top = h ** np.arange(len(self.numerator)) @ self.numerator
        point: Array = top / float(h ** np.arange(len(self.denominator)) @ self.denominator)
        return point

    def derivative(self, h: float) -> Array:
        """du/ds at h, by the quotient rule."""
        bottom = float(h ** np.arange(len(self.denominator)) @ self.denominator)
        slope: Array = (_slope(self.numerator, h) - self(h) * float(_slope(self.denominator, h))) / bottom
        return slope

    def segment(self, h: float, end: Array) -> SeriesSegment:
        """The path up to the corrected point at pseudo-arclength h."""
        return SeriesSegment(self, h, end - self(h), self.order + 1)


def _slope(coefficients: Array, h: float) -> Array:
    k = np.arange(1, len(coefficients))
    slope: Array = (k * h ** (k - 1)) @ coefficients[1:]
    return slope


def approximant(coefficients: Array, weights: Array) -> Pade:
    """The approximant of degrees (K - K // 2, K // 2) of a series of order K, of reach 0.

    The denominator makes the coefficients K - m + 1..K of its product with the series vanish, in least squares over the
    components (simultaneous, or type II, Pade approximation; Baker and Graves-Morris, Section 8.1), measured in
    the metric. The series is first written in an orthonormal basis of its own terms, so the least-squares problem has
    order m whatever N is; and scaled to a radius of convergence of 1, so that it is well conditioned.
    """
    order = len(coefficients) - 1
    m = order // 2
    sizes = np.sqrt((coefficients**2) @ weights)
    radius = 1.0
    if sizes[1] > 0.0 and sizes[-1] > 0.0:
        radius = float((sizes[1] / sizes[-1]) ** (1.0 / (order - 1)))
    scaled = coefficients * (radius ** np.arange(order + 1))[:, None]
    terms = np.asarray(np.linalg.qr((scaled * np.sqrt(weights)).T, mode="r")).T
    rows = range(order - m + 1, order + 1)
    matrix = np.concatenate([np.stack([terms[j - i] for i in range(1, m + 1)], axis=1) for j in rows])
    right = np.concatenate([terms[j] for j in rows])
    d = np.concatenate(([1.0], np.linalg.lstsq(matrix, -right, rcond=NUMERICAL_RANK)[0]))
    numerator = np.array([d[: j + 1] @ scaled[j::-1][: m + 1] for j in range(order - m + 1)])
    # Undo the scaling: s = radius * t.
    back = radius ** -np.arange(order + 1.0)
    return Pade(numerator * back[: order - m + 1, None], d * back[: m + 1], order, 0.0)


def best(series: Array, weights: Array, accuracy: float, series_reach: float, safety: float) -> Pade | None:
    """The approximant with the longest range among the highest orders; None if none reaches beyond the series.

    The range is where two successive orders agree, short of the first pole. A pole that appears at one order and not
    at the next is an artefact (a Froissart doublet), so an order that it spoils gives way to a lower one; a pole of
    the path's own stays, and ends the range of all of them.
    """
    order = len(series) - 1
    # Terms whose squares overflow have no sizes.
    if order < 4 or not np.isfinite(series_reach) or np.abs(series).max() > HUGE:
        return None
    shapes = [approximant(series[: k + 1], weights) for k in range(order, max(order - DEGREES, 2), -1)]
    longest, reach = shapes[0], 0.0
    for upper, lower in pairwise(shapes):
        agreed = _agreement(upper, lower, accuracy, series_reach, weights)
        if agreed > reach:
            longest, reach = upper, agreed
    if safety * reach <= series_reach:
        return None
    return Pade(longest.numerator, longest.denominator, longest.order, safety * reach)


def _agreement(upper: Pade, lower: Pade, accuracy: float, series_reach: float, weights: Array) -> float:
    """How far two approximants agree; looked for on the way out, so that no gap in between is jumped over."""
    measure = Tolerance(relative=accuracy).measure
    end = min(LONGEST_RANGE * series_reach, *(BEFORE_POLE * first_pole(curve.denominator) for curve in (upper, lower)))
    agreed = 0.0
    if end > series_reach:
        for s in np.geomspace(series_reach, end, RANGES_LOOKED_AT):
            point = upper(float(s))
            if not measure(point - lower(float(s)), weights) <= 1.0:
                break
            agreed = float(s)
    return agreed


def first_pole(denominator: Array) -> float:
    """The smallest positive real root of the denominator; inf where there is none."""
    trimmed = np.trim_zeros(denominator, "b")
    if len(trimmed) < 2:
        return float("inf")
    roots = np.polynomial.polynomial.polyroots(trimmed)
    real = roots[np.abs(roots.imag) <= REAL * np.abs(roots)].real
    positive = real[real > 0.0]
    return float(positive.min()) if positive.size else float("inf")
