"""The path of Freudenstein and Roth's function, exactly.

Eliminating x1 and lam from the two equations leaves polynomials in t = x2.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.polynomial import Polynomial

from continuation.arrays import Array

_X1 = Polynomial([214.0 / 6.0, 114.0 / 6.0, 4.0 / 6.0, -11.0 / 6.0])
_LAM = Polynomial([4.0 / 12.0, -6.0 / 12.0, -2.0 / 12.0, 1.0 / 12.0])


def curve(t: Array) -> Array:
    """Points (x1, x2, lam) at t = x2, shape (..., 3): the start is t = -2, the target t = 4."""
    return np.stack((_X1(t), t, _LAM(t)), axis=-1)


def limit_points(component: Literal["x1", "lam"]) -> Array:
    """Rows (x1, x2, lam) where `component` is stationary, in the order of the path, shape (2, 3)."""
    polynomial = {"x1": _X1, "lam": _LAM}[component]
    return curve(np.sort(polynomial.deriv().roots()))


def turning_points() -> Array:
    """The limit points in lam, shape (2, 3)."""
    return limit_points("lam")
