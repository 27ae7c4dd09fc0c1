"""Pictures of a study."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.chart.panels import (
    Axes,
    Figure,
    Mark,
    gridded,
    looks_of,
    panels,
    plain_ticks,
    rows_of_marks,
    to_round_off,
)
from continuation.chart.results import WORK, Results, Row, by_size, excess, some
from continuation.plot.drawing import COLOURS

Line = tuple[str, dict[str, Any], Sequence[tuple[float, float]]]
"""Name, style, points."""

Rows = tuple[str, Sequence[Row], str]
"""Name, runs, remark."""


def _names(value: str | Sequence[str]) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)


@frozen
class Lines:
    """Work against an error or the size ``"n"``, both logarithmic: lower is better.

    Errors fall to the right. A panel shows a problem (for n, a family) and kind of work, with failures. Outside methods
    are grey.

    Attributes
    ----------
    across : str
        Error name, or ``"n"``.
    work, problems, methods : sequence of str
        Default: all problems and methods.
    """

    across: str
    work: tuple[str, ...] = field(converter=_names)
    problems: Sequence[str] | None = None
    methods: Sequence[str] | None = None

    def draw(self, results: Results) -> Figure:
        """Draw the figure.

        Parameters
        ----------
        results : Results

        Raises
        ------
        ImportError, ValueError
            Without matplotlib; for unknown names.
        """
        sizes = self.across == "n"
        some("work", self.work, WORK)
        some("error", [self.across], ["n", *results.errors])
        looks = looks_of(results, some("methods", self.methods, results.methods))
        subjects = results.families if sizes else some("problems", self.problems, results.problems)
        cases = [(subject, work) for subject in subjects for work in self.work]
        columns = len(self.work) if len(self.work) > 1 else min(2, len(subjects))
        figure, axes = panels(len(cases), columns, results.title)
        for ax, (subject, work) in zip(axes, cases):
            of = {"family" if sizes else "problem": subject}
            self._panel(ax, [self._line(results.of(method=m, **of), m, work, look) for m, look in looks.items()])
            ax.set_title(subject, fontsize="medium", loc="left")
            ax.set_ylabel(WORK[work])
        for ax in axes[-columns:]:
            ax.set_xlabel("size n" if sizes else results.errors[self.across])
        return figure

    def _line(self, rows: Sequence[Row], method: str, work: str, look: dict[str, Any]) -> Line:
        if self.across == "n":
            return method, look, by_size(rows, work)
        points = [point for row in rows if (point := row.placed(self.across, work)) is not None]
        failed = sum(row.failed for row in rows)
        return method + (f" ({failed} of {len(rows)} failed)" if failed else ""), look, points

    def _panel(self, axes: Axes, lines: Sequence[Line]) -> None:
        drawn = [
            (points[-1][1] if points else 0.0, axes.plot(*np.reshape(points, (-1, 2)).T, label=name, **look)[0])
            for name, look, points in lines
            if points or "failed" in name
        ]
        # The key has the order of the curves' ends.
        key = [line for _, line in sorted(drawn, key=lambda pair: -pair[0])]
        axes.legend(handles=key, loc="upper left", bbox_to_anchor=(1.0, 1.03), frameon=False, fontsize="small")
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(x=0.06, y=0.08)
        if self.across != "n":
            to_round_off(axes)
        else:
            plain_ticks(axes.xaxis)
        plain_ticks(axes.yaxis)
        gridded(axes)


@frozen
class Profile:
    """A row for each method: the `excess` of every solved run, the median, and the percentage solved.

    Methods that solve most stand above, quicker ones first. Outside methods are grey.

    Attributes
    ----------
    work : str
        One of `WORK`.
    """

    work: str

    def draw(self, results: Results) -> Figure:
        """Draw the figure.

        Parameters
        ----------
        results : Results

        Raises
        ------
        ImportError, ValueError
            Without matplotlib; for an unknown work.
        """
        far = excess(results, next(iter(results.errors)), self.work)
        found = []
        for method in results.methods:
            runs = far[[row.method == method for row in results.rows]]
            values = runs[np.isfinite(runs)]
            share = values.size / runs.size
            median = float(np.median(values)) if values.size else math.inf
            colour = "0.45" if results.of(method=method)[0].outside else COLOURS[0]
            marks: list[Mark] = [(value, {"marker": "o", "color": colour, "alpha": 0.35}) for value in values]
            if marks:
                marks.append((median, {"marker": "|", "color": colour, "markersize": 16, "markeredgewidth": 2.5}))
            found.append((-share, median, (method, marks, f"{share:.0%} solved")))
        figure, axes = rows_of_marks(results.title, [row for _, _, row in sorted(found, key=lambda each: each[:2])])
        axes.set_xlabel(f"{WORK[self.work]}, over the least of equally accurate runs; line: median")
        return figure


ACCURACY = (
    ("≤ 1e-12", 1e-12, "#08306b"),
    ("1e-9", 1e-9, "#2171b5"),
    ("1e-6", 1e-6, "#6baed6"),
    ("1e-3", 1e-3, "#fdae6b"),
    ("more", math.inf, "#d94801"),
)
"""Error classes of three digits (readers tell five colours apart)."""


@frozen
class Dumbbell:
    """Best outside method, named in a remark, against ours, a row for each problem by ratio; colours show errors.

    The best is the quickest without failure, on the last rung. With `every`, each method has a row, each rung a point.

    Attributes
    ----------
    error, work : str
    problems : sequence of str, optional
    every : bool
    """

    error: str
    work: str
    problems: Sequence[str] | None = None
    every: bool = False

    def draw(self, results: Results) -> Figure:
        """Draw the figure.

        Parameters
        ----------
        results : Results

        Raises
        ------
        ImportError, ValueError
            Without matplotlib; for unknown names.
        """
        some("error", [self.error], results.errors)
        some("work", [self.work], WORK)
        problems = some("problems", self.problems, results.problems)
        lines = (self._all_methods if self.every else self._best)(results, problems)
        marked = [(name, [self._mark(row) for row in rows], said) for name, rows, said in lines]
        figure, axes = rows_of_marks(results.title, marked)
        axes.set_xlabel(WORK[self.work])
        key = [("ours", "D", "0.3"), ("theirs, error:", "o", "0.3"), *((name, "s", c) for name, _, c in ACCURACY)]
        handles = [axes.plot([], [], mark, color=colour, label=name)[0] for name, mark, colour in key]
        figure.legend(handles=handles, loc="outside lower left", ncols=len(handles), frameon=False, fontsize="small",
                      handletextpad=0.1, columnspacing=1.2)  # fmt: skip
        return figure

    def _mark(self, row: Row) -> Mark:
        colour = next(colour for _, most, colour in ACCURACY if not row.errors[self.error] > most)
        look = {"color": colour, "markersize": 7, "markeredgecolor": "white"}
        return row.work(self.work), {"marker": "o" if row.outside else "D", **look}

    def _best(self, results: Results, problems: Sequence[str]) -> list[Rows]:
        found = []
        for problem in problems:
            rows = [row for row in results.of(problem=problem) if not row.failed]
            last = max((row.rung for row in rows), default=math.nan)
            ranked = sorted((row for row in rows if row.rung == last), key=lambda row: row.work(self.work))
            ours, best = ([row for row in ranked if row.outside is outside][:1] for outside in (False, True))
            ratio, said = math.nan, "no rival" if ours else "ours failed"
            if best and ours:
                ratio = best[0].work(self.work) / ours[0].work(self.work)
                much = f"{max(ratio, 1.0 / ratio):.{1 if 0.1 < ratio < 10.0 else 0}f}×"
                said = f"{much} {'quicker' if ratio >= 1.0 else 'slower'} than {best[0].method}"
            found.append((math.inf if math.isnan(ratio) else -ratio, (problem, ours + best, said)))
        return [line for _, line in sorted(found, key=lambda pair: pair[0])]

    def _all_methods(self, results: Results, problems: Sequence[str]) -> list[Rows]:
        lines: list[Rows] = []
        for problem in problems:
            whole = sorted(results.of(problem=problem), key=lambda row: (row.failed, row.work(self.work)))
            head = f"{problem}:  "
            for method in dict.fromkeys(row.method for row in whole):
                rows = results.of(problem=problem, method=method)
                said = ", ".join(dict.fromkeys(row.failure for row in rows if row.failed))
                lines.append((head + method, [row for row in rows if not row.failed], said))
                head = ""
            lines.append(("", [], ""))
        return lines[:-1]
