"""The tube of a proof around a path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from continuation.plot.drawing import COLOURS, SMOOTHNESS, Axes, axes_or_new, tidy
from continuation.point.segment import cubic

VISIBLE = 0.004
"""Least drawn radius in picture widths: most tubes are thinner than a line."""


def plot_tube(cells: Any, gaps: Sequence[tuple[float, float]], component: int, axes: Axes | None = None) -> Axes:
    """Draw the tube in one component of y against the parameter; `gaps` are arclengths."""
    axes = axes_or_new(axes)
    from matplotlib.collections import PolyCollection

    rows = zip(cells.begin, cells.end, cells.slope_begin, cells.slope_end)
    cubics = [[cubic(*row).at(t) for t in np.linspace(0.0, 1.0, SMOOTHNESS)] for row in rows]
    curves = np.array(cubics)[:, :, [-1, component]]
    wide = np.maximum(cells.radius[:, [-1, component]], VISIBLE * np.ptp(curves, axis=(0, 1)))[:, None]
    lo = np.minimum(curves[:, 1:], curves[:, :-1]) - wide
    hi = np.maximum(curves[:, 1:], curves[:, :-1]) + wide
    corners = [np.stack([x[..., 0], y[..., 1]], axis=-1) for x, y in ((lo, lo), (hi, lo), (hi, hi), (lo, hi))]
    boxes = np.stack(corners, axis=2).reshape(-1, 4, 2)
    axes.add_collection(PolyCollection(list(boxes), color=COLOURS[0], alpha=0.35, linewidth=0.0))
    axes.plot(*curves.reshape(-1, 2).T, ".-", markevery=SMOOTHNESS, color=COLOURS[0], linewidth=0.8)
    begins, ends = ([gap[k] for gap in gaps] for k in (0, 1))
    beside = np.isin(cells.place[:, 1], begins) | np.isin(cells.place[:, 0], ends)
    axes.plot(*curves[beside][:, [0, -1]].reshape(-1, 2).T, "x", color=COLOURS[1])
    axes.set(xlabel="parameter", ylabel=f"y[{component}]", title=f"{len(gaps)} gaps" if gaps else "complete")
    return tidy(axes)
