"""Pictures of orbits: in the plane of two components, or over a period. matplotlib is imported when one is drawn."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from continuation.curves.beginning import as_point
from continuation.plot.drawing import COLOURS, Axes, axes_or_new, tidy
from problems.orbits.orbit import PeriodicOrbit

DRAWN_TIMES = 500
"""Points of a drawn orbit: beside a screen's 2000 pixels its corners are not seen."""


def plot_orbits(
    orbit: PeriodicOrbit,
    points: Iterable[Any] | None = None,
    axes: Axes | None = None,
    *,
    over: int | str = 0,
    of: int = 1,
) -> Axes:
    """Draw orbits of a path: one component over another one, or over time.

    Parameters
    ----------
    orbit : PeriodicOrbit
        Of the path, or another one with as many intervals and of the same degree.
    points : iterable of Step, LocatedEvent or (y, p), optional
        Which of them, as ``path.steps[::5]``; by default the one that it starts from.
    axes : matplotlib Axes, optional
    over : int or "t", default 0
        The horizontal component; "t" for time, in the units of f.
    of : int, default 1
        The vertical one.

    Raises
    ------
    ImportError
        Without matplotlib.
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
