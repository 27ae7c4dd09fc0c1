"""Power series of the path, and vector Pade approximants, which reach beyond its radius of convergence."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from attrs import field, frozen

from continuation.arrays import ROOT_OF_ROUND_OFF, Array
from continuation.linear.silence import without_warnings
from continuation.metric import INVERTIBLE
from continuation.tolerance import Tolerance

DEGREES = 6
"""Successive orders that are compared."""

LONGEST_RANGE, LOOKS = 8.0, 25
"""Longest range, in ranges of the series, and its number of samples, a tenth apart."""


@frozen(eq=False)
class Series:
    """The curve sum_j c_j s^j / sum_i d_i s^i in pseudo-arclength s.

    `coefficients`: c, shape (L + 1, N + 1). `denominator`: d, shape (m + 1,), first 1.
    """

    coefficients: Array
    reach: float
    denominator: Array = field(factory=lambda: np.ones(1))

    @property
    def order(self) -> int:
        """Order of the original series, L + m."""
        return len(self.coefficients) + len(self.denominator) - 2

    def __call__(self, h: float) -> Array:
        """The point at h."""
        point: Array = _value(self.coefficients, h) / _value(self.denominator, h)
        return point

    def derivative(self, h: float) -> Array:
        """Derivative du/ds at h."""
        top = _slope(self.coefficients, h) - self(h) * _slope(self.denominator, h)
        slope: Array = top / _value(self.denominator, h)
        return slope


def _value(coefficients: Array, h: float) -> Array:
    value: Array = h ** np.arange(len(coefficients)) @ coefficients
    return value


def _slope(coefficients: Array, h: float) -> Array:
    k = np.arange(1, len(coefficients))
    slope: Array = (k * h ** (k - 1)) @ coefficients[1:]
    return slope


def approximant(coefficients: Array, weights: Array) -> Series:
    """The approximant of degrees (K - K // 2, K // 2) of a series of order K.

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
    d = np.concatenate(([1.0], np.linalg.lstsq(matrix, -right)[0]))
    numerator = np.array([d[: j + 1] @ scaled[j::-1][: m + 1] for j in range(order - m + 1)])
    # Undo the scaling s = radius * t.
    back = radius ** -np.arange(order + 1.0)
    return Series(numerator * back[: order - m + 1, None], 0.0, d * back[: m + 1])


@without_warnings(all="ignore")
def best(series: Array, weights: Array, accuracy: float, series_reach: float, safety: float) -> Series | None:
    """Approximant with the longest range, or None.

    In the range successive orders agree and have no pole. A pole of one order alone is an artefact (Froissart doublet).
    """
    order = len(series) - 1
    if order < 4 or not np.isfinite(series_reach) or np.abs(series).max() * INVERTIBLE > 1.0:
        return None
    shapes = [approximant(series[: k + 1], weights) for k in range(order, max(order - DEGREES, 2), -1)]
    reaches = [_agreement(*pair, accuracy, series_reach, safety, weights) for pair in pairwise(shapes)]
    k = int(np.argmax(reaches))
    if safety * reaches[k] <= series_reach:
        return None
    return Series(shapes[k].coefficients, safety * reaches[k], shapes[k].denominator)


def _agreement(
    upper: Series, lower: Series, accuracy: float, series_reach: float, safety: float, weights: Array
) -> float:
    measure = Tolerance(relative=accuracy).measure
    end = min(LONGEST_RANGE * series_reach, *(safety * first_pole(curve.denominator) for curve in (upper, lower)))
    agreed = 0.0
    if end > series_reach:
        for s in np.geomspace(series_reach, end, LOOKS).tolist():
            if not measure(upper(s) - lower(s), weights) <= 1.0:
                break
            agreed = s
    return agreed


def first_pole(denominator: Array) -> float:
    """The denominator's smallest positive real root, or inf."""
    roots = np.polynomial.polynomial.polyroots(np.trim_zeros(denominator, "b"))
    real = roots.real[np.abs(roots.imag) <= ROOT_OF_ROUND_OFF * np.abs(roots)]
    return float(real[real > 0.0].min(initial=np.inf))
