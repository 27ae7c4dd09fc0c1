"""A picture of an answer."""

from __future__ import annotations

from textwrap import fill
from typing import Any

import numpy as np

from continuation.plot.along import plot_components
from continuation.plot.drawing import COLOURS, TURN, Axes, require_matplotlib, tidy

Solution = Any


def draw_solution(solution: Solution) -> Any:
    """The message, the path to x if any, the face and the residual."""
    require_matplotlib()
    from matplotlib import pyplot

    traced = solution.paths[solution.best] if solution.paths else None
    figure = pyplot.figure(figsize=(9.0 if traced else 6.5, 4.2), layout="constrained")
    figure.suptitle(fill(solution.message, 95 if traced else 68), fontsize="small")
    panels = figure.subplots(1, 2 if traced else 1, squeeze=False)[0]
    draw_face(solution, panels[-1])
    if traced is not None:
        shown = min(solution.problem.n, traced.steps[0].y.size) if traced.steps else 0
        if shown:
            chosen = np.unique(np.linspace(0, shown - 1, min(shown, 8)).round().astype(int))
            plot_components(traced, panels[0], names=[f"$x_{{{i}}}$" for i in chosen], components=chosen.tolist())
        of = f"path {solution.best % len(solution.paths) + 1} of {len(solution.paths)}: {traced.status.name}"
        panels[0].set_title(of, fontsize="small", loc="left")
    return figure


def draw_face(solution: Solution, axes: Axes) -> Axes:
    """Bars for each i: up for the distance of x_i to its bounds, down for w_i, each relative to its largest.

    A ring marks two values within the residual.
    """
    axes.set_title(f"{solution.outcome.name}: residual {solution.residual:.0e}", fontsize="small", loc="left")
    if solution.x is None or solution.w is None:
        axes.set(xticks=[], yticks=[])
        axes.annotate("no point", (0.5, 0.5), xycoords="axes fraction", ha="center", color="0.4")
        return tidy(axes)
    problem = solution.problem
    inside = np.minimum(solution.x - problem.lower, problem.upper - solution.x)
    # A free x is always inside.
    up, down = np.where(np.isfinite(inside), inside, np.abs(solution.x) + 1.0), np.abs(solution.w)
    # Values below the residual are errors.
    held, pushed = (np.abs(values) > np.maximum(solution.residual, 0.0) for values in (up, down))
    width = float(np.clip(110.0 / problem.n, 0.5, 9.0))
    for where, values, side, colour in ((held, up, 1.0, COLOURS[0]), (pushed, down, -1.0, COLOURS[1])):
        heights = side * values[where] / values.max(initial=np.finfo(float).tiny)
        axes.vlines(np.flatnonzero(where), 0.0, heights, color=colour, linewidth=width)
    neither = np.flatnonzero(~held & ~pushed)
    axes.plot(neither, np.zeros(neither.size), **TURN)
    axes.axhline(0.0, color="0.4", linewidth=0.8)
    axes.set_yticks([-0.5, 0.5], ["w", "x"])
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel(f"i: {np.count_nonzero(held)} of {problem.n} off their bounds")
    axes.set_ylim(-1.08, 1.08)
    return tidy(axes)
