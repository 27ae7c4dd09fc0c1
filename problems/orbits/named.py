"""Orbits of models, by name."""

from __future__ import annotations

import numpy as np

from problems.orbits.models import Model
from problems.orbits.orbit import PeriodicOrbit

_AT_HOPF = {
    "normal-form": ([0.0, 0.0], 0.0),
    "brusselator": ([1.0, 2.0], 2.0),
    "lorenz": ([float(np.sqrt(8.0 / 3.0 * 451.0 / 19.0))] * 2 + [451.0 / 19.0], 470.0 / 19.0),
}
"""Hopf points in closed form."""


def from_model(model: str = "brusselator", intervals: int = 20, degree: int = 4, radius: float = 0.01) -> PeriodicOrbit:
    """Orbits that leave a model's Hopf point.

    Parameters
    ----------
    model : str
        normal-form, brusselator or lorenz.
    intervals, degree : int
    radius : float
        Size of the first orbit.
    """
    if model not in _AT_HOPF:
        raise ValueError(f"model: expected one of {', '.join(_AT_HOPF)}, found {model!r}")
    x, p = _AT_HOPF[model]
    return PeriodicOrbit.from_hopf(Model(model), (np.array(x), p), radius=radius, intervals=intervals, degree=degree)
