"""Two pictures of a study: lines of work against something, and the fraction solved against work.

Names are written at what they name, so that no legend is searched. Methods of the study are in colours, outside ones in
grey.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.chart.measures import by_size, exponents, ratios
from continuation.chart.panels import (
    LINE,
    Axes,
    Figure,
    look_of,
    looks_of,
    name_ends,
    panels,
    plain_ticks,
    some,
    tidy,
    to_round_off,
)
from continuation.chart.results import WORK, Results, Row

Chooser = Callable[[Row], float | None]
"""The ladder's value that the library chooses for a row's problem; None where it does not choose."""


@frozen
class Line:
    """A line of a panel: its name, how it looks, its points, and a point of it that is to be seen."""

    name: str
    look: dict[str, Any]
    points: Sequence[tuple[float, float]]
    seen: tuple[float, float] | None = None


def _names(value: str | Sequence[str]) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)


@frozen
class Lines:
    """Work against an error, the size ``"n"`` or the ladder's ``"rung"``, both logarithmic: lower is better.

    Against an error, which falls to the right and ends at round-off, there is a panel a problem and kind of work, and a
    line a method. Against n there is a panel a family, and a line a method with its exponent. Against the rung there
    is a panel a method, and a line a problem, over its least. How many runs of a line failed is said with its name.

    Attributes
    ----------
    across : str
        One of the results' errors, ``"n"`` or ``"rung"``.
    work : str or sequence of str
        In `WORK`; several stand side by side.
    problems, methods : sequence of str, optional
        Which; all by default.
    chosen : callable, optional
        From a row to the ladder's value that is marked by a large dot.
    """

    across: str
    work: tuple[str, ...] = field(converter=_names)
    problems: Sequence[str] | None = None
    methods: Sequence[str] | None = None
    chosen: Chooser | None = None

    @property
    def name(self) -> str:
        """Of the file."""
        return "-".join((self.across, *self.work))

    def draw(self, results: Results) -> Figure:
        """The matplotlib figure.

        Parameters
        ----------
        results : Results

        Raises
        ------
        ImportError, ValueError
            Without matplotlib; if the error, the work, a problem or a method is none of the results'.
        """
        for work in self.work:
            results.check(None if self.across in ("n", "rung") else self.across, work)
        problems = some("problems", self.problems, results.problems)
        methods = some("methods", self.methods, results.methods)
        looks = looks_of(results, methods)
        per = {"n": results.families, "rung": methods}.get(self.across, problems)
        columns = len(self.work) if len(self.work) > 1 else min(2, len(per))
        figure, axes = panels(len(per) * len(self.work), columns, results.title)
        for k, ax in enumerate(axes):
            subject, work = per[k // len(self.work)], self.work[k % len(self.work)]
            if self.across == "n":
                lines = self._by_size(results, subject, work, looks)
            elif self.across == "rung":
                lines = self._by_rung(results, subject, work, problems)
            else:
                lines = self._by_error(results, subject, work, looks)
            label = {"n": "size n", "rung": results.ladder}.get(self.across) or results.errors[self.across]
            ax.set_title(subject, fontsize="medium", loc="left")
            ax.set_xlabel(label if k + columns >= len(axes) else "")
            ax.set_ylabel(WORK[work].label + (" over the least" if self.across == "rung" else ""))
            self._panel(ax, lines)
        return figure

    def _by_error(self, results: Results, problem: str, work: str, looks: dict[str, Any]) -> list[Line]:
        lines = []
        for method, look in looks.items():
            rows = results.of(problem=problem, method=method)
            points = [point for row in rows if (point := row.placed(self.across, work)) is not None]
            failed = sum(row.failed for row in rows)
            said = f" ({failed} of {len(rows)} failed)" if failed else ""
            lines += [Line(method + said, look, points)] if rows else []
        return lines

    def _by_size(self, results: Results, family: str, work: str, looks: dict[str, Any]) -> list[Line]:
        powers = {method: power for (of, method), power in exponents(results, work).items() if of == family}
        named = {m: f"{m}, $n^{{{powers[m]:.1f}}}$" if math.isfinite(powers[m]) else m for m in looks}
        return [Line(named[m], look, by_size(results, family, m, work)) for m, look in looks.items()]

    def _by_rung(self, results: Results, method: str, work: str, problems: Sequence[str]) -> list[Line]:
        lines = []
        for k, problem in enumerate(problems):
            rows = [row for row in results.of(problem=problem, method=method) if not row.failed]
            least = min((row.work(work) for row in rows), default=1.0)
            points = sorted((row.rung, row.work(work) / least) for row in rows)
            choice = self.chosen(rows[0]) if self.chosen is not None and rows else None
            seen = None if choice is None else (choice, float(np.interp(choice, *np.array(points).T)))
            lines.append(Line(problem, look_of(k), points, seen))
        return lines

    def _panel(self, axes: Axes, lines: Sequence[Line]) -> None:
        lines = [line for line in lines if line.points or "failed" in line.name]
        for line in lines:
            if line.points:
                axes.plot(*zip(*line.points), **line.look)
            if line.seen is not None:
                axes.plot(*line.seen, "o", markersize=11, color=line.look["color"], zorder=1, alpha=0.45)
        axes.set_yscale("log")
        if self.across != "rung":
            axes.set_xscale("log")
        axes.margins(x=0.06, y=0.08)
        if self.across not in ("n", "rung"):
            to_round_off(axes)
        plain_ticks(axes.yaxis)
        tidy(axes)
        ends = [(*line.points[-1], line.name, line.look["color"]) for line in lines if line.points]
        name_ends(axes, ends)
        absent = [line.name.split(" (")[0] for line in lines if not line.points]
        if absent:
            text = f"failed: {', '.join(absent)}"
            axes.annotate(text, (0.02, 0.02), xycoords="axes fraction", fontsize="x-small", color="0.4")


@frozen
class Profile:
    """The performance profile: the fraction of all runs that a method solves within a factor of the least work.

    At the right edge, where each line has its name, is what it solves at all; on the left what it solves best.

    Dolan and More, Benchmarking optimization software with performance profiles, Math. Program. 91, 2002.

    Attributes
    ----------
    work : str
        One of `WORK`.
    """

    work: str

    @property
    def name(self) -> str:
        """Of the file."""
        return f"profile-{self.work}"

    def draw(self, results: Results) -> Figure:
        """The matplotlib figure.

        Parameters
        ----------
        results : Results

        Raises
        ------
        ImportError, ValueError
            Without matplotlib; for an unknown work.
        """
        found = ratios(results, self.work)
        figure, (axes,) = panels(1, 1, results.title, height=max(3.2, LINE * len(found) + 1.2))
        everything = np.concatenate(list(found.values()))
        # To the power of ten at which all that is ever solved is solved.
        widest = 10.0 ** max(1, np.ceil(np.log10(everything[np.isfinite(everything)].max(initial=1.0))))
        ends = []
        for method, look in looks_of(results, results.methods).items():
            values = np.sort(found[method])
            finite = values[np.isfinite(values)]
            # A step at every ratio, from (1, fraction of best) on; the line goes on to the edge of the panel.
            x = np.concatenate(([1.0], finite, [widest]))
            y = np.concatenate(([np.sum(finite <= 1.0)], np.arange(1, finite.size + 1), [finite.size])) / values.size
            axes.step(x, y, where="post", **{**look, "marker": ""})
            ends.append((widest, float(y[-1]), f"{method}  {100 * y[-1]:.0f} %", look["color"]))
        axes.set_xscale("log")
        axes.set(xlim=(1.0, widest), ylim=(-0.03, 1.04), ylabel="fraction solved")
        axes.set_xlabel(f"{WORK[self.work].label}, over the least of all methods")
        tidy(axes)
        name_ends(axes, ends)
        return figure


