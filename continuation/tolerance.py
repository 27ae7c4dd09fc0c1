"""When a correction is small enough: by its length in the metric of the path."""

from __future__ import annotations

import math
import sys

from attrs import field, frozen

from continuation.arguments.checks import FRACTION, POSITIVE, complain, is_number
from continuation.arrays import Array
from continuation.metric import norm

LEAST_TOLERANCE = sys.float_info.epsilon**2
"""Of a fraction of the path: after an increment of the size of round-off the error is about its square."""


@frozen
class Tolerance:
    """An increment d is small if its length in the metric of the path is at most `relative`: ``|d|_W <= relative``.

    The default metric measures each component by how far the path has gone in it, so this is a fraction of the path,
    in any units. After the last increment of Newton's method the error is about its square; so a tolerance below the
    root of round-off, as the default is, asks for points whose residual is round-off of what H is made of there, and
    a looser one for points whose error is about its square.

    Attributes
    ----------
    relative : float
        Of the last increment.
    residual : float
        Points with a larger residual, in the units of the equations, do not count; infinity (the default) judges by
        increments and round-off alone.
    """

    relative: float = field(default=1e-8, validator=FRACTION)
    residual: float = field(default=float("inf"), validator=POSITIVE)

    def measure(self, increment: Array, weights: Array) -> float:
        """The length of an increment in units of the tolerance: small is <= 1.

        Parameters
        ----------
        increment : ndarray, shape (N + 1,)
        weights : ndarray, shape (N + 1,)
            Of the metric.
        """
        return norm(weights, increment) / self.relative


def as_tolerance(value: float | Tolerance) -> Tolerance:
    """A Tolerance as it is, a number as its relative part.

    Raises `TypeError` if it is neither a Tolerance nor a real number. Raises `ValueError` if the number is not between
    the square of round-off and 1: it is a fraction of the path.
    """
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
