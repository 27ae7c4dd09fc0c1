"""The paper's figures: x against lambda, one panel per example."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from continuation.path import Path
from continuation.plot import plot_components
from continuation.plot.drawing import TURN, require_matplotlib
from problems.paper import Example

ZOOM = (0.1, 0.2, 0.5, 0.5)
"""Inset near turning points: left, bottom, width, height in panel units."""


def draw_examples(examples: Sequence[Example], paths: Sequence[Path], columns: int = 5) -> Any:
    """Draw one panel per example, lambda from 1 to 0, from KKT paths y = (x, z1, z2)."""
    require_matplotlib()
    from matplotlib.figure import Figure

    columns = min(columns, len(examples))
    rows = -(-len(examples) // columns)
    figure = Figure(figsize=(3.0 * columns, 2.8 * rows + 0.4), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, example, path in zip(panels, examples, paths):
        draw_example(example, path, axes)
    for axes in panels[::columns]:
        axes.set_ylabel("$x$")
    for axes in panels[len(examples) :]:
        axes.set_visible(False)
    _key(figure, max(panels, key=lambda axes: len(axes.get_lines())))
    return figure


def draw_example(example: Example, path: Path, axes: Any) -> None:
    """Draw x in one panel, with an inset around turning points."""
    _draw_x(example, path, axes)
    axes.set_xlim(1.03, -0.03)
    axes.set_title(f"{example.number}: {_typeset(example.stated_class)}", fontsize="medium")
    turns = path.turning_points
    if turns:
        inset = axes.inset_axes(ZOOM)
        _draw_x(example, path, inset)
        inset.set_xlim(1.3 * max(turn.lam for turn in turns), 0.0)
        largest = max(float(turn.y[: example.q.size].max()) for turn in turns)
        inset.set_ylim(-0.1 * largest, 1.4 * largest)
        inset.set(xlabel="", title=f"{len(turns)} turning points")
        inset.title.set_fontsize("small")
        inset.tick_params(labelsize="small")


def _draw_x(example: Example, path: Path, axes: Any) -> None:
    components = range(example.q.size)
    plot_components(path, axes, names=[f"$x_{{{i}}}$" for i in components], components=components, legend=False)


def _key(figure: Any, fullest: Any) -> None:
    handles, labels = fullest.get_legend_handles_labels()
    handles.append(figure.axes[0].plot([], [], **TURN)[0])
    figure.legend(handles, [*labels, "turning point"], loc="outside lower center", ncols=len(handles), frameon=False)


def _typeset(matrix_class: str) -> str:
    text = matrix_class.replace("N-bar", r"$\bar{N}$").replace("E0^s", "$E_0^s$")
    return re.sub(r"\b([A-Z])0\b", r"$\1_0$", text)
