"""Pictures as data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.plot.drawing import COLOURS

Mark = tuple[str, tuple[Any, ...], Mapping[str, Any]]


Picture = Sequence[Mark]


def draw(shown: Picture, axes: Any) -> None:
    """Draw the marks in order."""
    for method, arguments, options in shown:
        getattr(axes, method)(*arguments, **options)


def picture(*marks: Mark, title: str = "", legend: Mapping[str, Any] | None = None, **settings: Any) -> Picture:
    """Combine marks; a labelled one adds a legend.

    Parameters
    ----------
    *marks : tuple
        From `mark`, `arrow`, `rectangle`.
    title : str
    legend : mapping, optional
        Legend options.
    **settings
        For ``axes.set``.
    """
    labelled = any(options.get("label") for _, _, options in marks)
    key = [mark("legend", **{"frameon": False, **(legend or {})})] if labelled else []
    return [*marks, mark("set", **settings), mark("set_title", title, fontsize="medium"), *key]


def mark(method: str, *arguments: Any, **options: Any) -> Mark:
    """One call of an axes method: ``mark("plot", x, y, label="height")``.

    Parameters
    ----------
    method : str
    *arguments, **options
        For the method.
    """
    return method, arguments, options


def arrow(start: tuple[float, float], along: tuple[float, float], k: int, label: str = "") -> list[Mark]:
    """An arrow in data units; zero length draws only its legend."""
    style = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.008, "color": COLOURS[k], "zorder": 3}
    drawn = [mark("quiver", *start, *along, **style)] if np.hypot(*along) > 0.0 else []
    return [*drawn, mark("plot", [], [], color=COLOURS[k], label=label)]


def rectangle(place: Array, width: float, height: float, **style: Any) -> Mark:
    """A rectangle about `place` = (x, y, angle in radians)."""
    x, y, angle = place
    corners = 0.5 * np.array([[-width, width, width, -width], [-height, -height, height, height]])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    across, up = turn @ corners
    return mark("fill", x + across, y + up, **{"facecolor": "0.85", "edgecolor": "0.3", **style})
