"""Colours, markers and line styles: each line has its own of all three, for print and for colour-blind readers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from continuation.plot.drawing import COLOURS, STYLES, require_matplotlib

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p")

CHART_DPI = 110

Axes = Any
Figure = Any


def line_style(k: int) -> dict[str, Any]:
    """Colour, marker and style of the k-th line: 7, 10 and 4 of them, so that 140 lines differ."""
    return {
        "color": COLOURS[k % len(COLOURS)],
        "marker": MARKERS[k % len(MARKERS)],
        "linestyle": STYLES[k % len(STYLES)],
        "linewidth": 1.3,
        "markersize": 5.5,
        "markeredgecolor": "white",
        "markeredgewidth": 0.5,
    }


def ring(size: float) -> dict[str, Any]:
    """A black ring around what is best."""
    shape = {"marker": "o", "markerfacecolor": "none", "markeredgecolor": "black", "linestyle": "none"}
    return {**shape, "markersize": size}


def panels(count: int, most_across: int = 3, height: float = 3.1) -> tuple[Figure, list[Axes]]:
    """A figure with `count` panels in rows of at most `most_across`; none of them more than asked for."""
    require_matplotlib()
    from matplotlib.figure import Figure as Canvas

    across = 2 if count == 4 else min(count, most_across)
    down = -(-count // across)
    width = 5.6 if across == 1 else 3.4 * across
    figure = Canvas(figsize=(0.9 + width, 0.9 + height * down), layout="constrained")
    grid = figure.subplots(down, across, squeeze=False).ravel()
    for unused in grid[count:]:
        unused.remove()
    return figure, list(grid[:count])


def legend_below(figure: Figure, names: Sequence[str], title: str, marks: Mapping[str, dict[str, Any]] = {}) -> None:
    """One legend for all panels, outside of them: the lines by name, then the marks by their style; a title above."""
    from matplotlib.lines import Line2D

    if title:
        figure.suptitle(title, fontsize="medium")
    styles = [*map(line_style, range(len(names))), *marks.values()]
    # No larger than a line of text.
    handles = [Line2D([], [], **{**style, "markersize": min(style["markersize"], 9.0)}) for style in styles]
    labels = [*names, *marks]
    width = figure.get_size_inches()[0]
    longest = max((len(label) for label in labels), default=1)
    most = max(1, int(width / (0.5 + 0.075 * longest)))
    # As few rows as fit, and as few columns as those rows need, so that no row is nearly empty.
    rows = -(-len(labels) // most)
    columns = max(1, -(-len(labels) // max(1, rows)))
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False, fontsize="small")


def label(axes: Sequence[Axes], across: str, up: str) -> None:
    """Axis labels for a grid of panels: on y at the left edge, on x wherever there is no panel below."""
    columns = axes[0].get_subplotspec().get_gridspec().ncols
    for k, panel in enumerate(axes):
        if k % columns == 0:
            panel.set_ylabel(up)
        if k + columns >= len(axes):
            panel.set_xlabel(across, fontsize="small")


def few_ticks(axis: Any, beside: bool = False) -> None:
    """Plain numbers at 1, 2 and 5 of each decade, or closer, where the axis spans little; the decades otherwise.

    Numbers `beside` each other, and not above, need more room.
    """
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    if high <= (100.0 if beside else 300.0) * low:
        near, far = ((1.0, 2.0, 5.0), (1.0, 3.0)) if beside else ((1.0, 1.5, 2.0, 3.0, 5.0, 7.0), (1.0, 2.0, 5.0))
        subs = far if high > 10.0 * low else near
        axis.set_major_locator(LogLocator(subs=subs))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def tidy(axes: Axes, title: str) -> None:
    """A title; no frame, a light grid at the decades."""
    axes.set_title(title, fontsize="medium")
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(which="major", color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
