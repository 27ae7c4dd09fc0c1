"""Orbits of the models that have a name, for the shell and for those who want to see one."""

from __future__ import annotations

import numpy as np

from problems.orbits.models import Model
from problems.orbits.orbit import PeriodicOrbit

_AT_HOPF = {
    "normal-form": ([0.0, 0.0], 0.0),
    "brusselator": ([1.0, 2.0], 2.0),
    "lorenz": ([float(np.sqrt(8.0 / 3.0 * 451.0 / 19.0))] * 2 + [451.0 / 19.0], 470.0 / 19.0),
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
    x, p = _AT_HOPF[model]
    return PeriodicOrbit.from_hopf(Model(model), (np.array(x), p), radius=radius, intervals=intervals, degree=degree)
