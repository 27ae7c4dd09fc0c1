"""Vector Pade approximants with one denominator: series beyond their radius of convergence."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.point.segment import SeriesSegment
from continuation.tolerance import Tolerance

DEGREES = 6
"""Successive orders compared."""

LONGEST_RANGE = 8.0
"""In ranges of the series."""

RANGES_LOOKED_AT, BEFORE_POLE = 25, 0.95
"""Samples of the agreement, a tenth apart; part of the way to a pole that is sampled."""

NUMERICAL_RANK, REAL = 1e-14, 1e-8
"""Relative round-off of singular values, and of a real root's imaginary part."""

HUGE = 1e150
"""The square of a larger number overflows."""


@frozen(eq=False)
class Pade:
    """The rational curve sum_j p_j s^j / sum_i d_i s^i.

    `numerator`: shape (L + 1, N + 1). `denominator`: shape (m + 1,), ascending, first 1. `order`: L + m.
    """

    numerator: Array
    denominator: Array
    order: int
    reach: float

    def __call__(self, h: float) -> Array:
        """Return the point at pseudo-arclength h."""
        top = h ** np.arange(len(self.numerator)) @ self.numerator
        point: Array = top / float(h ** np.arange(len(self.denominator)) @ self.denominator)
        return point

    def derivative(self, h: float) -> Array:
        """Return du/ds at h."""
        bottom = float(h ** np.arange(len(self.denominator)) @ self.denominator)
        slope: Array = (_slope(self.numerator, h) - self(h) * float(_slope(self.denominator, h))) / bottom
        return slope

    def segment(self, h: float, end: Array) -> SeriesSegment:
        """Return the path up to the corrected point at h."""
        return SeriesSegment(self, h, end - self(h), self.order + 1)


def _slope(coefficients: Array, h: float) -> Array:
    k = np.arange(1, len(coefficients))
    slope: Array = (k * h ** (k - 1)) @ coefficients[1:]
    return slope


def approximant(coefficients: Array, weights: Array) -> Pade:
    """Return the approximant of degrees (K - K // 2, K // 2) of a series of order K, with reach 0.

    Coefficients K - m + 1..K of denominator times series vanish in least squares (simultaneous, or type II,
    approximation; Baker and Graves-Morris, Section 8.1).
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
    # Undo the scaling s = radius * t.
    back = radius ** -np.arange(order + 1.0)
    return Pade(numerator * back[: order - m + 1, None], d * back[: m + 1], order, 0.0)


def best(series: Array, weights: Array, accuracy: float, series_reach: float, safety: float) -> Pade | None:
    """Return the approximant with the longest range, or None.

    In its range successive orders agree, without a pole. A pole of one order is an artefact (Froissart doublet); a
    pole of the path limits all.
    """
    order = len(series) - 1
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
    """Return the denominator's smallest positive real root, or inf."""
    trimmed = np.trim_zeros(denominator, "b")
    if len(trimmed) < 2:
        return float("inf")
    roots = np.polynomial.polynomial.polyroots(trimmed)
    real = roots[np.abs(roots.imag) <= REAL * np.abs(roots)].real
    positive = real[real > 0.0]
    return float(positive.min()) if positive.size else float("inf")
