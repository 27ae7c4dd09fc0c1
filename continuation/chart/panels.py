"""Parts of study pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from continuation.chart.results import Results
from continuation.plot.drawing import COLOURS, STYLES, Axes, require_matplotlib

MARKERS = "os^DvPX<>p"

GREYS = ("0.25", "0.45", "0.6")

LINE = 0.165
"""Line height of small print, inches."""

Figure = Any

Dot = tuple[float, dict[str, Any]]


def _look(k: int, outside: bool) -> dict[str, Any]:
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
    """Styles by method, outside methods apart."""
    outside = {row.method: row.outside for row in results.rows}
    return {m: _look([o for o in methods if outside[o] == outside[m]].index(m), outside[m]) for m in methods}


def panels(count: int, across: int, title: str, height: float = 3.0, width: float = 7.4) -> tuple[Figure, list[Axes]]:
    """A figure with `count` panels, `across` a row."""
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


def rows_of_marks(title: str, lines: Sequence[tuple[str, Sequence[Dot], str]]) -> tuple[Figure, Axes]:
    """A row of joined marks for each line (name, marks, remark), with a logarithmic axis."""
    figure, (axes,) = panels(1, 1, title, height=1.2 + 1.35 * LINE * len(lines), width=9.0)
    for k, (_, marks, said) in enumerate(lines):
        axes.plot([x for x, _ in marks], [-k] * len(marks), color="0.8", linewidth=2.0, zorder=1)
        for x, look in marks:
            axes.plot(x, -k, **look)
        axes.annotate(said, (1.01, -k), xycoords=("axes fraction", "data"), va="center", fontsize="small")
    axes.set_xscale("log")
    axes.set_ylim(0.6 - len(lines), 0.6)
    axes.set_yticks(range(0, -len(lines), -1), [name for name, _, _ in lines], fontsize="small")
    axes.tick_params(axis="y", length=0.0)
    gridded(axes)
    axes.grid(axis="y", visible=False)
    return figure, axes


def gridded(axes: Axes) -> None:
    """Remove the frame; add a light grid."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(which="major", color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
