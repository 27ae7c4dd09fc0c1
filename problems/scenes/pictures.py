"""A picture as data: what the methods of axes draw, in order, and the settings of the axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.plot.drawing import COLOURS

Mark = tuple[str, tuple[Any, ...], Mapping[str, Any]]
"""A method of axes, its arguments, and its options."""


@frozen(eq=False)
class Picture:
    """Marks in the order in which they are drawn; where one has a label there is a legend."""

    marks: Sequence[Mark]
    title: str
    legend: Mapping[str, Any]
    settings: Mapping[str, Any]

    def on(self, axes: Any) -> None:
        """Draw it.

        Parameters
        ----------
        axes : matplotlib Axes
        """
        for method, arguments, options in self.marks:
            getattr(axes, method)(*arguments, **options)
        axes.set(**self.settings)
        axes.set_title(self.title, fontsize="medium")
        if any(options.get("label") for _, _, options in self.marks):
            axes.legend(**{"frameon": False, **self.legend})


def picture(*marks: Mark, title: str = "", legend: Mapping[str, Any] | None = None, **settings: Any) -> Picture:
    """A picture of marks.

    Parameters
    ----------
    *marks : tuple
        Of `mark`, `arrow`, `rectangle`.
    title : str
    legend : mapping, optional
        Options of the legend.
    **settings
        For ``axes.set``.
    """
    return Picture(marks, title, legend or {}, settings)


def mark(method: str, *arguments: Any, **options: Any) -> Mark:
    """What a method of axes draws: ``mark("plot", x, y, label="height")``.

    Parameters
    ----------
    method : str
    *arguments, **options
        Of the method.
    """
    return method, arguments, options


def arrow(start: tuple[float, float], along: tuple[float, float], k: int, label: str = "") -> list[Mark]:
    """An arrow in the units of the axes, in colour k, with a label in the legend; none where it has no length."""
    style = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.008, "color": COLOURS[k], "zorder": 3}
    drawn = [mark("quiver", *start, *along, **style)] if np.hypot(*along) > 0.0 else []
    return [*drawn, mark("plot", [], [], color=COLOURS[k], label=label)]


def rectangle(place: Array, width: float, height: float, **style: Any) -> Mark:
    """A body whose middle is at (x, y) and which is turned by an angle; the style is for ``axes.fill``."""
    x, y, angle = place
    corners = 0.5 * np.array([[-width, width, width, -width], [-height, -height, height, height]])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    across, up = turn @ corners
    return mark("fill", x + across, y + up, **{"facecolor": "0.85", "edgecolor": "0.3", **style})
