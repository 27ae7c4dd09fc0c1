"""Work against size: a line a method, with the fitted exponent."""

from __future__ import annotations

import numpy as np
from attrs import frozen
from scipy.optimize import isotonic_regression

from continuation.chart.results import WORK, Results
from continuation.chart.style import Axes, Figure, few_ticks, label, legend_below, line_style, panels, tidy
from continuation.chart.table import Cell, Table

FITTED = 3
"""Sizes that a fit needs at least; it is made to the larger half of them, since costs are asymptotic."""

_APART = 0.075
"""Least distance of two labels, as a fraction of the panel's height."""


def exponents(results: Results, work: str) -> dict[tuple[str, str], float]:
    """The exponent p of work ~ n^p for each (family, method), by least squares on logarithms; NaN below `FITTED` sizes.

    A size with several runs counts with their mean; failures are left out.

    Parameters
    ----------
    results : Results
    work : str
        One of `WORK`.

    Raises
    ------
    ValueError
        If the error or the work is none of the results'.
    """
    results.check(work=work)
    found = {}
    for family in results.families:
        for method in results.methods:
            points = _points(results, family, method, work)
            found[family, method] = _slope(points) if len(points) >= FITTED else float("nan")
    return found


def _points(results: Results, family: str, method: str, work: str) -> list[tuple[float, float]]:
    rows = [row for row in results.of(family=family, method=method) if not row.failed]
    sizes = sorted({row.n for row in rows})
    return [(float(n), float(np.mean([row.work(work) for row in rows if row.n == n]))) for n in sizes]


def _slope(points: list[tuple[float, float]]) -> float:
    upper = points[-max(FITTED, len(points) // 2) :]
    n, cost = np.log(np.array(upper)).T
    return float(np.polyfit(n, cost, 1)[0])


def scaling_table(results: Results, work: str) -> Table:
    """One line a family and method: the work at each size, and the exponent."""
    sizes = sorted({row.n for row in results.rows})
    powers = exponents(results, work)
    lines: list[tuple[Cell, ...]] = []
    for (family, method), power in powers.items():
        costs = dict(_points(results, family, method, work))
        if costs:
            lines.append((family, method, *(costs.get(float(n), float("nan")) for n in sizes), power))
    return Table(("family", "method", *(f"n = {n}" for n in sizes), "exponent"), lines)


def draw_scaling(results: Results, work: str) -> Figure:
    """Draw work against n, one panel a family; the label of each line has its exponent.

    Parameters
    ----------
    results : Results
    work : str
        One of `WORK`.

    Returns
    -------
    matplotlib Figure

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for an unknown work.
    """
    results.check(work=work)
    powers = exponents(results, work)
    figure, axes = panels(len(results.families))
    for family, ax in zip(results.families, axes):
        ends = []
        for k, method in enumerate(results.methods):
            points = _points(results, family, method, work)
            if not points:
                continue
            power = powers[family, method]
            ax.plot(*zip(*points), **line_style(k))
            if not np.isnan(power):
                ends.append((points[-1][1], f"$n^{{{power:.1f}}}$", line_style(k)["color"]))
        ax.set_xscale("log")
        ax.set_yscale("log")
        few_ticks(ax.yaxis)
        tidy(ax, family)
        _name_ends(ax, ends)
    label(axes, "size $n$", WORK[work].label)
    legend_below(figure, results.methods, results.title)
    return figure


def _name_ends(axes: Axes, ends: list[tuple[float, str, str]]) -> None:
    """Write (height, text, colour) beside the panel, as near to their heights as keeps them apart."""
    if not ends:
        return
    ends = sorted(ends)
    to_panel = axes.transData + axes.transAxes.inverted()
    heights = np.array([to_panel.transform((axes.get_xlim()[0], height))[1] for height, _, _ in ends])
    apart = _APART * np.arange(len(ends))
    for place, (_, text, colour) in zip(isotonic_regression(heights - apart).x + apart, ends):
        axes.annotate(text, (1.02, place), xycoords="axes fraction", fontsize="small", va="center", color=colour)


@frozen
class Scaling:
    """The scaling chart as a figure of a study."""

    work: str

    @property
    def name(self) -> str:
        """Of the file."""
        return f"scaling-{self.work}"

    def draw(self, results: Results) -> Figure:
        """See `draw_scaling`."""
        return draw_scaling(results, self.work)

    def table(self, results: Results) -> Table:
        """See `scaling_table`."""
        return scaling_table(results, self.work)
