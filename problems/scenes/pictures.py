"""What several pictures of scenes have: arrows, and bodies."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.plot.drawing import COLOURS


def arrow(axes: Any, start: tuple[float, float], along: tuple[float, float], k: int, label: str = "") -> None:
    """An arrow in the units of the axes, in colour k, with a label in the legend; none where it has no length."""
    if np.hypot(*along) > 0.0:
        axes.quiver(*start, *along, angles="xy", scale_units="xy", scale=1.0, width=0.008, color=COLOURS[k], zorder=3)
    axes.plot([], [], color=COLOURS[k], label=label)


def rectangle(axes: Any, place: Array, width: float, height: float, **style: Any) -> None:
    """A body whose middle is at (x, y) and which is turned by an angle; the style is for ``axes.fill``."""
    x, y, angle = place
    corners = 0.5 * np.array([[-width, width, width, -width], [-height, -height, height, height]])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    across, up = turn @ corners
    axes.fill(x + across, y + up, **{"facecolor": "0.85", "edgecolor": "0.3", **style})
