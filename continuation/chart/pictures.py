"""Pictures of a study."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.chart.panels import (
    Dot,
    Figure,
    gridded,
    looks_of,
    panels,
    rows_of_marks,
)
from continuation.chart.results import WORK, Results, Row, excess, some
from continuation.plot.drawing import COLOURS, Axes

Labelled = tuple[str, dict[str, Any], Sequence[tuple[float, float]]]


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
    work, problems : sequence of str
        Default: all problems.
    """

    across: str
    work: tuple[str, ...] = field(converter=_names)
    problems: Sequence[str] | None = None

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
        looks = looks_of(results, results.methods)
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

    def _line(self, rows: Sequence[Row], method: str, work: str, look: dict[str, Any]) -> Labelled:
        if self.across == "n":
            solved = [row for row in rows if not row.failed]
            sizes = {n: [row.work(work) for row in solved if row.n == n] for n in sorted({row.n for row in solved})}
            return method, look, [(n, float(np.mean(found))) for n, found in sizes.items()]
        points = [point for row in rows if (point := row.placed(self.across, work)) is not None]
        failed = sum(row.failed for row in rows)
        return method + (f" ({failed} of {len(rows)} failed)" if failed else ""), look, points

    def _panel(self, axes: Axes, lines: Sequence[Labelled]) -> None:
        drawn = [
            (points[-1][1] if points else 0.0, axes.plot(*np.reshape(points, (-1, 2)).T, label=name, **look)[0])
            for name, look, points in lines
            if points or "failed" in name
        ]
        key = [line for _, line in sorted(drawn, key=lambda pair: -pair[0])]
        axes.legend(handles=key, loc="upper left", bbox_to_anchor=(1.0, 1.03), frameon=False, fontsize="small")
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(x=0.06, y=0.08)
        if self.across != "n":
            axes.invert_xaxis()
        gridded(axes)


@frozen
class Profile:
    """A row for each method: the `excess` of every solved run, the median, and the percentage solved.

    Methods that solve most stand above, quicker ones first. Outside methods are grey. With ``by="problem"`` each
    problem has a row, ordered by the median of the methods that are not outside.

    Attributes
    ----------
    work : str
        One of `WORK`.
    by : {"method", "problem"}
    """

    work: str
    by: str = "method"

    def draw(self, results: Results) -> Figure:
        """Draw the figure.

        Parameters
        ----------
        results : Results

        Raises
        ------
        ImportError, ValueError
            Without matplotlib; for an unknown work or `by`.
        """
        far = excess(results, next(iter(results.errors)), self.work)
        (by,) = some("by", [self.by], ["method", "problem"])
        runs = [*zip(results.rows, far.tolist())]
        found = []
        for name in dict.fromkeys(getattr(row, by) for row, _ in runs):
            mine = [(row, value) for row, value in runs if getattr(row, by) == name]
            judged = [value for row, value in mine if by == "method" or not row.outside]
            solved = [value for value in judged if np.isfinite(value)]
            share, median = len(solved) / max(len(judged), 1), float(np.median(solved)) if solved else math.inf
            marks: list[Dot] = [
                (value, {"marker": "o", "color": "0.45" if row.outside else COLOURS[0], "alpha": 0.35})
                for row, value in mine
                if np.isfinite(value)
            ]
            if solved:
                marks.append((median, {"marker": "|", "color": "0.2", "markersize": 16, "markeredgewidth": 2.5}))
            found.append((-share, median, (name, marks, f"{share:.0%} solved")))
        figure, axes = rows_of_marks(results.title, [row for _, _, row in sorted(found, key=lambda each: each[:2])])
        axes.set_xlabel(f"{WORK[self.work]}, over the least of equally accurate runs; line: median")
        return figure
