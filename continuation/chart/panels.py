"""What every picture of a study is made of: panels, colours, ticks, and names beside what they name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import isotonic_regression

from continuation.chart.results import ERROR_FLOOR, Results
from continuation.plot.drawing import COLOURS, STYLES, require_matplotlib

MARKERS = "os^DvPX<>p"

GREYS = ("0.25", "0.45", "0.6")

LINE = 0.165
"""Inches from one line of small print to the next."""

Axes = Any
Figure = Any


def some(kind: str, wanted: Sequence[str] | None, known: Sequence[str]) -> Sequence[str]:
    """The names that are wanted, all by default; an error that names the `kind` if one is not known."""
    if wanted is None:
        return known
    if not wanted or not set(wanted) <= set(known):
        raise ValueError(f"{kind}: expected some of {', '.join(known)}, found {wanted}")
    return wanted


def look_of(k: int, outside: bool = False) -> dict[str, Any]:
    """Colour, marker and style of the k-th line."""
    colours = GREYS if outside else COLOURS
    return {
        "color": colours[k % len(colours)],
        "marker": MARKERS[k % len(MARKERS)],
        "linestyle": STYLES[1 + k % 3] if outside else STYLES[k // len(COLOURS) % len(STYLES)],
        "linewidth": 1.5,
        "markersize": 5.5,
        "markeredgecolor": "white",
        "markeredgewidth": 0.5,
    }


def looks_of(results: Results, methods: Sequence[str]) -> dict[str, dict[str, Any]]:
    """By method: the k-th of ours, or of the others."""
    outside = {row.method: row.outside for row in results.rows}
    return {m: look_of([o for o in methods if outside[o] == outside[m]].index(m), outside[m]) for m in methods}


def panels(count: int, across: int, title: str, height: float = 3.0, width: float = 7.4) -> tuple[Figure, list[Axes]]:
    """A figure as wide as a page, with `count` panels, `across` of them in a row."""
    require_matplotlib()
    from matplotlib.figure import Figure as Canvas

    down = -(-count // across)
    size = width if across == 1 else 5.0 * across, 0.4 + height * down
    figure = Canvas(figsize=size, dpi=110, layout="constrained")
    grid = figure.subplots(down, across, squeeze=False).ravel()
    for unused in grid[count:]:
        unused.remove()
    figure.suptitle(title, fontsize="medium")
    return figure, list(grid[:count])


def tidy(axes: Axes) -> None:
    """No frame, and a light grid at the decades."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(which="major", color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)


def plain_ticks(axis: Any) -> None:
    """Plain numbers at 1, 2 and 5 of each decade where the axis spans little; the decades otherwise."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    if high <= 300.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high > 8.0 * low else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def to_round_off(axes: Axes) -> None:
    """Errors fall to the right; round-off is named where it is near."""
    from matplotlib.ticker import FuncFormatter, NullLocator

    least, largest = axes.get_xlim()
    # Three decades at least, and round-off where no more than those lie between.
    least = 0.4 * ERROR_FLOOR if least < 1e3 * ERROR_FLOOR else least
    largest = max(largest, 1e3 * least)
    axes.set_xlim(largest, least)
    stride = 3 if largest > 1e7 * least else 1
    first, last = round(math.log10(ERROR_FLOOR)), math.floor(math.log10(largest))
    axes.set_xticks([10.0**k for k in range(first, last + 1, stride) if 10.0**k > least])
    axes.xaxis.set_major_formatter(FuncFormatter(lambda e, _: "round-off" if e < 2.0 * ERROR_FLOOR else f"{e:.0e}"))
    axes.xaxis.set_minor_locator(NullLocator())


def name_ends(axes: Axes, ends: Sequence[tuple[float, float, str, str]]) -> None:
    """Write names (x, y, text, colour) beside the panel, as near to their points as keeps them apart, and tie them."""
    if not ends:
        return
    ends = sorted(ends, key=lambda end: end[1])
    to_panel = axes.transData + axes.transAxes.inverted()
    heights = np.array([to_panel.transform((x, y))[1] for x, y, _, _ in ends])
    # Titles and labels leave three quarters of the figure to its panels.
    rows = axes.get_subplotspec().get_gridspec().nrows
    apart = LINE / (0.75 * axes.figure.get_size_inches()[1] / rows) * np.arange(len(ends))
    places = isotonic_regression(heights - apart).x + apart
    places = np.minimum(np.maximum(places, apart), max(1.0, apart[-1]) - apart[::-1])
    for place, (x, y, text, colour) in zip(places, ends):
        # From the middle of the name's left side.
        tie = {"arrowstyle": "-", "color": colour, "linewidth": 0.6, "shrinkA": 1.0, "shrinkB": 4.0, "relpos": (0, 0.5)}
        where: dict[str, Any] = {"textcoords": "axes fraction", "va": "center", "annotation_clip": False}
        axes.annotate(text, (x, y), (1.05, place), fontsize="small", color=colour, arrowprops=tie, **where)
