"""A zero of a function between two places, by Brent's method, where the function has values in between."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from scipy.optimize import brentq


class _NoValueError(Exception):
    """Brentq has no way to stop but this."""


def zero_between(function: Callable[[float], float], low: float, high: float, **options: Any) -> float | None:
    """A zero of a function that has different signs at two places; None where it overflows, or is NaN, on the way.

    The options are those of `scipy.optimize.brentq`.

    References
    ----------
    Brent, Algorithms for Minimization Without Derivatives, 1973, chapter 4.
    """

    def value(t: float) -> float:
        found = function(t)
        if math.isnan(found):
            raise _NoValueError
        return found

    try:
        return float(brentq(value, low, high, **options))
    except _NoValueError:
        return None
