"""Tolerance of corrections."""

from __future__ import annotations

import math
import sys

from attrs import field, frozen

from continuation.arguments.checks import FRACTION, POSITIVE, expect, is_number
from continuation.arrays import Array
from continuation.metric import norm

LEAST_TOLERANCE = sys.float_info.epsilon**2
"""Fraction of the path: the error that an increment of round-off leaves."""


@frozen
class Tolerance:
    """An increment d is small if ``|d|_W <= relative``, in the metric of the path.

    Newton's error is about the last increment's square. So up to the root of round-off (the default) residuals must be
    round-off; looser tolerances accept errors of about their square.

    Attributes
    ----------
    relative : float
    residual : float
        Largest residual; default infinity: increments and round-off decide.
    """

    relative: float = field(default=1e-8, validator=FRACTION)
    residual: float = field(default=float("inf"), validator=POSITIVE)

    def measure(self, increment: Array, weights: Array) -> float:
        """An increment's length in tolerances.

        Parameters
        ----------
        increment : ndarray, shape (N + 1,)
        weights : ndarray, shape (N + 1,)
            Metric.
        """
        return norm(weights, increment) / self.relative


def as_tolerance(value: float | Tolerance) -> Tolerance:
    """A Tolerance; a number is its relative part. `TypeError` or `ValueError` for others."""
    expected = "a positive finite number or a Tolerance"
    relative = value.relative if isinstance(value, Tolerance) else value
    expect(is_number(relative), "tolerance", expected, value, TypeError)
    expect(0.0 < relative < math.inf, "tolerance", expected, value)
    expect(relative < 1.0, "tolerance", "less than 1, since it is a fraction of the path", value)
    least = f"at least {LEAST_TOLERANCE:.1e}, the square of round-off"
    expect(relative >= LEAST_TOLERANCE, "tolerance", least, value)
    return value if isinstance(value, Tolerance) else Tolerance(relative=float(value))
