"""The performance profile: which fraction of problems a method solves within a factor of the best one's work.

Dolan and More, Benchmarking optimization software with performance profiles, Math. Program. 91, 2002.
"""

from __future__ import annotations

import math

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.chart.results import WORK, Results
from continuation.chart.style import Axes, Figure, label, legend_below, line_style, panels, tidy
from continuation.chart.table import Cell, Table

MOST_LINES = 6
"""Of one panel."""


def ratios(results: Results, work: str, family: str | None = None) -> dict[str, Array]:
    """For each method, a number a problem and rung: its work over the least of all methods; infinite where it failed.

    Methods without a rung take part in each.
    """
    results.check(work=work)
    rows = results.of(family=family)
    rungs = sorted({row.rung for row in rows if not math.isnan(row.rung)}) or [math.nan]
    cost: dict[tuple[str, str], dict[float, float]] = {}
    for row in rows:
        value = math.inf if row.failed else row.work(work)
        for rung in rungs if math.isnan(row.rung) else (row.rung,):
            cost.setdefault((row.problem, row.method), {})[rung] = value
    found: dict[str, list[float]] = {method: [] for method in results.methods}
    for problem in dict.fromkeys(row.problem for row in rows):
        for rung in rungs:
            costs = {method: cost.get((problem, method), {}).get(rung, math.inf) for method in found}
            least = min(costs.values())
            for method, value in costs.items():
                found[method].append(value / least if math.isfinite(value) else math.inf)
    return {method: np.array(values) for method, values in found.items()}


def profile_table(results: Results, work: str) -> Table:
    """One line a method and family: the fraction solved at all, and within 1, 2 and 10 times the best work."""
    lines: list[tuple[Cell, ...]] = [
        (family, method, values.size, *(float((values <= limit).mean()) for limit in (1.0, 2.0, 10.0)),
         float(np.isfinite(values).mean()))
        for family in results.families
        for method, values in ratios(results, work, family).items()
    ]  # fmt: skip
    return Table(("family", "method", "runs", "best", "within 2", "within 10", "solved"), lines)


def draw_profile(results: Results, work: str) -> Figure:
    """Draw the profiles: the fraction solved against the factor over the best work.

    One panel a family; where there are more than six methods, one for each six of them, which can be told apart.

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
    found = {family: ratios(results, work, family) for family in results.families}
    count = len(results.methods)
    groups = np.array_split(np.arange(count), -(-count // MOST_LINES))
    figure, axes = panels(len(found) * len(groups), most_across=max(len(groups), 3 // len(groups) * len(groups)))
    everything = np.concatenate([values for lines in found.values() for values in lines.values()])
    # To the power of ten at which all that is ever solved is solved.
    widest = 10.0 ** max(1, np.ceil(np.log10(everything[np.isfinite(everything)].max(initial=1.0))))
    shown = [(family, list(lines.values()), group) for family, lines in found.items() for group in groups]
    for (family, values_of, group), ax in zip(shown, axes):
        for k in group:
            _line(ax, values_of[k], k, (k - group[0] + 0.5) / len(group), widest)
        ax.set_xscale("log")
        ax.set_xlim(1.0, widest)
        ax.set_ylim(-0.03, 1.04)
        part = f", methods {group[0] + 1} to {group[-1] + 1}" if len(groups) > 1 else ""
        tidy(ax, f"{family}{part}")
    label(axes, f"{WORK[work].quantity},\nover the least of all methods", "fraction solved")
    legend_below(figure, results.methods, results.title)
    return figure


def _line(ax: Axes, values: Array, k: int, place: float, widest: float) -> None:
    finite = np.sort(values[np.isfinite(values)])
    # A step at every ratio, from (1, fraction of best) on; the line goes on to the edge of the panel.
    x = np.concatenate(([1.0], finite, [widest]))
    y = np.concatenate(([np.mean(values <= 1.0)], np.arange(1, finite.size + 1), [finite.size]))
    y[1:] /= values.size
    ax.step(x, y, where="post", **{**line_style(k), "marker": ""})
    # Two markers a line, at places of its own, where lines run together.
    places = widest ** ((place + np.array([0.0, 0.5])) % 1.0)
    ax.plot(places, [np.mean(values <= place) for place in places], **{**line_style(k), "linestyle": "none"})


@frozen
class Profile:
    """The performance profile as a figure of a study."""

    work: str

    @property
    def name(self) -> str:
        """Of the file."""
        return f"profile-{self.work}"

    def draw(self, results: Results) -> Figure:
        """See `draw_profile`."""
        return draw_profile(results, self.work)

    def table(self, results: Results) -> Table:
        """See `profile_table`."""
        return profile_table(results, self.work)
