"""The tube around a path as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Cells
from continuation.point.segment import HermiteSegment

POINTS = 12
"""Of each cell."""

VISIBLE = 0.004
"""Radii are drawn at least this wide, in widths of the picture: most tubes are thinner than a line."""


def draw(cells: Cells, gaps: Sequence[tuple[float, float]], component: int, axes: Any = None) -> Any:
    """The tube in one component against the parameter.

    Parameters
    ----------
    cells : Cells
    gaps : sequence of tuple of float
        Arclengths at their ends.
    component : int
        Of y.
    axes : matplotlib axes, optional

    Returns
    -------
    matplotlib axes
    """
    from matplotlib.figure import Figure

    if axes is None:
        axes = Figure(figsize=(6.0, 4.0), layout="constrained").subplots()
    points = [_points(cells, k) for k in range(len(cells))]
    every = np.concatenate(points)[:, [-1, component]]
    least = VISIBLE * np.maximum(np.ptp(every, axis=0), 1e-300)
    for k, curve in enumerate(points):
        across, along = np.maximum(cells.radius[k, [-1, component]], least)
        lam, y = curve[:, -1], curve[:, component]
        for lo, hi in zip(range(POINTS - 1), range(1, POINTS)):
            box_x = min(lam[lo], lam[hi]) - across, max(lam[lo], lam[hi]) + across
            box_y = min(y[lo], y[hi]) - along, max(y[lo], y[hi]) + along
            axes.fill(np.repeat(box_x, 2), [*box_y, *box_y[::-1]], color="C0", alpha=0.35, linewidth=0.0)
        axes.plot(lam, y, color="C0", linewidth=0.8)
    axes.plot(every[::POINTS, 0], every[::POINTS, 1], ".", color="black", markersize=3, label="nodes")
    for begin, end in gaps:
        ends = [p for p, (a, b) in zip(points, cells.place) if b == begin or a == end]
        for curve in ends:
            axes.plot(curve[[0, -1], -1], curve[[0, -1], component], "x", color="C3")
    axes.set_xlabel("parameter")
    axes.set_ylabel(f"y[{component}]")
    axes.set_title(f"{len(gaps)} gaps" if gaps else "complete")
    return axes


def _points(cells: Cells, k: int) -> Array:
    cubic = HermiteSegment(cells.begin[k], cells.end[k], cells.slope_begin[k], cells.slope_end[k])
    return np.array([cubic.at(t) for t in np.linspace(0.0, 1.0, POINTS)])
