"""Tolerance of corrections."""

from __future__ import annotations

import math
import sys

from attrs import field, frozen

from continuation.arguments.checks import FRACTION, POSITIVE, complain, is_number
from continuation.arrays import Array
from continuation.metric import norm

LEAST_TOLERANCE = sys.float_info.epsilon**2
"""Fraction of the path: the error after an increment at round-off."""


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
    if not isinstance(value, Tolerance):
        if not is_number(value):
            raise complain(TypeError, "tolerance", expected, value)
        if not 0.0 < value < math.inf:
            raise complain(ValueError, "tolerance", expected, value)
        if value >= 1.0:
            raise complain(ValueError, "tolerance", "less than 1, since it is a fraction of the path", value)
    tolerance = value if isinstance(value, Tolerance) else Tolerance(relative=float(value))
    if tolerance.relative < LEAST_TOLERANCE:
        raise complain(ValueError, "tolerance", f"at least {LEAST_TOLERANCE:.1e}, the square of round-off", value)
    return tolerance
