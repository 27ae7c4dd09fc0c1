"""Vector fields with known periodic orbits: of textbooks, and in the units of their papers."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from problems.orbits.orbit import PeriodicOrbit


def normal_form(z: Any, p: Any, second: Any = 1.0) -> Array:
    """R' = r (p + second r^2 - r^4), theta' = 1: orbits of period 2 pi, and a fold of cycles at p = -second^2 / 4."""
    x, y = z
    r = x * x + y * y
    a = p + second * r - r * r
    return np.stack([a * x - y, a * y + x])


def van_der_pol(z: Any, mu: Any) -> Array:
    """Relaxation oscillations for large mu."""
    x, y = z
    return np.stack([y, mu * (1.0 - x * x) * y - x])


def brusselator(z: Any, b: Any) -> Array:
    """A chemical oscillation: equilibrium (1, b), a Hopf point at b = 2."""
    x, y = z
    return np.stack([1.0 - (b + 1.0) * x + x * x * y, b * x - x * x * y])


def roessler(z: Any, c: Any, a: Any = 0.2) -> Array:
    """Period doublings."""
    x, y, w = z
    return np.stack([-y - w, x + a * y, 0.2 + w * (x - c)])


def lorenz(z: Any, r: Any) -> Array:
    """A Hopf point at r = 470 / 19, orbits that end on a homoclinic one at r = 13.9266."""
    x, y, w = z
    return np.stack([10.0 * (y - x), r * x - y - x * w, x * y - 8.0 / 3.0 * w])


_AT_HOPF = {
    "normal-form": (normal_form, [0.0, 0.0], 0.0),
    "brusselator": (brusselator, [1.0, 2.0], 2.0),
    "lorenz": (lorenz, [float(np.sqrt(8.0 / 3.0 * 451.0 / 19.0))] * 2 + [451.0 / 19.0], 470.0 / 19.0),
}
"""Their Hopf points, in closed form."""


def from_model(model: str = "brusselator", intervals: int = 20, degree: int = 4, radius: float = 0.01) -> PeriodicOrbit:
    """The orbits that leave the Hopf point of a model.

    Parameters
    ----------
    model : str
        normal-form, brusselator or lorenz.
    intervals, degree : int
        Of the collocation.
    radius : float
        Of the orbit to begin with.
    """
    if model not in _AT_HOPF:
        raise ValueError(f"model: expected one of {', '.join(_AT_HOPF)}, found {model!r}")
    f, x, p = _AT_HOPF[model]
    return PeriodicOrbit.from_hopf(f, (np.array(x), p), radius=radius, intervals=intervals, degree=degree)
