"""Plots of orbits."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from continuation.curves.beginning import as_point
from continuation.plot.drawing import COLOURS, Axes, axes_or_new, tidy
from problems.orbits.orbit import PeriodicOrbit

DRAWN_TIMES = 500
"""Times per orbit: corners are invisible on 2000 pixels."""


def plot_orbits(
    orbit: PeriodicOrbit,
    points: Iterable[Any] | None = None,
    axes: Axes | None = None,
    *,
    over: int | str = 0,
    of: int = 1,
) -> Axes:
    """Draw orbits of a path: one component against another, or against time.

    Parameters
    ----------
    orbit : PeriodicOrbit
        With the path's intervals and degree.
    points : iterable of Step, LocatedEvent or (y, p), optional
        As ``path.steps[::5]``; default the start.
    axes : matplotlib Axes, optional
    over : int or "t", default 0
        Horizontal component, or time.
    of : int, default 1
        Vertical component.
    """
    axes = axes_or_new(axes)
    t = np.linspace(0.0, 1.0, DRAWN_TIMES)
    for k, point in enumerate([orbit.start()] if points is None else points):
        y, p = as_point(point)
        X = orbit.at(y, t)
        across = t * float(y[orbit.period_index]) if isinstance(over, str) else X[:, over]
        axes.plot(across, X[:, of], color=COLOURS[k % len(COLOURS)], label=f"{orbit.parameter_name} = {p:.5g}")
    axes.set_xlabel("t" if over == "t" else f"$x_{over}$")
    axes.set_ylabel(f"$x_{of}$")
    return tidy(axes)
