"""Work against the ladder's value itself, one line a problem: where the best value lies, and which one was chosen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import frozen

from continuation.chart.results import WORK, Results, Row
from continuation.chart.style import Figure, legend_below, line_style, panels, ring, tidy

Chooser = Callable[[Row], float | None]
"""The value that the library chooses for a row's problem; None where it does not choose."""

_BEST = ring(12)
_CHOSEN = {"marker": "|", "markersize": 20, "markeredgecolor": "black", "markeredgewidth": 2.5, "linestyle": "none"}
_TICKS = (1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0)


def draw_sweep(results: Results, work: str, chosen: Chooser | None = None) -> Figure:
    """Draw work, relative to the least of each line, against the ladder; one panel a method.

    Failures are left out of the lines; the best value of a line has a ring, the chosen one a bar of the line's colour.

    Parameters
    ----------
    results : Results
    work : str
    chosen : callable, optional

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for an unknown work.
    """
    results.check(work=work)
    figure, axes = panels(len(results.methods), most_across=2, height=3.6)
    for method, ax in zip(results.methods, axes):
        for k, problem in enumerate(results.problems):
            rows = [row for row in results.of(problem=problem, method=method) if not row.failed]
            if not rows:
                continue
            least = min(row.work(work) for row in rows)
            values = [(row.rung, row.work(work) / least) for row in rows]
            ax.plot(*zip(*values), **line_style(k))
            ax.plot(*min(values, key=lambda pair: pair[1]), zorder=1, **_BEST)
            choice = chosen(rows[0]) if chosen is not None else None
            if choice is not None:
                height = np.interp(choice, *np.array(values).T)
                ax.plot(choice, height, zorder=4, **{**_CHOSEN, "markeredgecolor": line_style(k)["color"]})
        ax.set_yscale("log")
        highest = max(2.0, ax.get_ylim()[1])
        ticks = [tick for tick in _TICKS if tick <= highest]
        ax.set_yticks(ticks, labels=[f"{tick:g}" for tick in ticks])
        ax.set_yticks([], minor=True)
        ax.set_ylim(0.9, highest)
        ax.set_xlabel(results.ladder)
        tidy(ax, method)
    axes[0].set_ylabel(f"{WORK[work].quantity},\nover the least of the line")
    marks = {"least": _BEST} if chosen is None else {"least": _BEST, "chosen by the library": _CHOSEN}
    legend_below(figure, results.problems, results.title, marks)
    return figure


@frozen
class Sweep:
    """The sweep as a figure of a study."""

    work: str
    chosen: Chooser | None = None

    @property
    def name(self) -> str:
        """Of the file."""
        return self.work

    def draw(self, results: Results) -> Figure:
        """See `draw_sweep`."""
        return draw_sweep(results, self.work, self.chosen)
