"""When a correction is small enough: a mixed absolute and relative rule."""

from __future__ import annotations

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array, largest
from continuation.checks import NOT_NEGATIVE, POSITIVE, POSITIVE_FINITE, complain, is_number


@frozen
class Tolerance:
    """An increment d of the point u is small if ``max_i |d_i| / (absolute + relative max(|u|_i, |u|_inf / 1e3)) <= 1``.

    Not absolute alone (round-off makes 1e-10 unreachable at N = 1000), not relative alone (zero is a solution too).
    A residual r counts as small if it is below `residual` in size; the default, infinity, judges by increments only,
    since a residual has the units of the equations and an increment those of the unknowns.
    """

    absolute: float = field(default=1e-8, validator=POSITIVE_FINITE)
    relative: float = field(default=1e-8, validator=NOT_NEGATIVE)
    residual: float = field(default=float("inf"), validator=POSITIVE)

    def measure(self, increment: Array, u: Array) -> float:
        """The largest increment in units of the tolerance: small is <= 1.

        Parameters
        ----------
        increment, u : ndarray, shape (N + 1,)
            A correction, and the point that it is added to.
        """
        scale = self.absolute + self.relative * np.maximum(np.abs(u), 1e-3 * largest(u))
        return largest(increment / scale)


def as_tolerance(value: float | Tolerance) -> Tolerance:
    """A Tolerance as it is, a number as both its absolute and its relative part.

    Raises
    ------
    TypeError
        If it is neither a Tolerance nor a real number.
    ValueError
        If the number is not positive and finite.
    """
    if isinstance(value, Tolerance):
        return value
    expected = "a positive finite number or a Tolerance"
    if not is_number(value):
        raise complain(TypeError, "tolerance", expected, value)
    if not (np.isfinite(value) and value > 0):
        raise complain(ValueError, "tolerance", expected, value)
    return Tolerance(absolute=float(value), relative=float(value))
