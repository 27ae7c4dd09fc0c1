"""The picture of who is quicker, by how much, and how exactly: a line a problem."""

from __future__ import annotations

import math
from collections.abc import Sequence

from attrs import frozen

from continuation.chart.panels import LINE, Axes, Figure, panels, some, tidy
from continuation.chart.results import WORK, Results, Row

ACCURACY = (
    ("≤ 1e-12", 1e-12, "#08306b"),
    ("1e-9", 1e-9, "#2171b5"),
    ("1e-6", 1e-6, "#6baed6"),
    ("1e-3", 1e-3, "#fdae6b"),
    ("more", math.inf, "#d94801"),
)
"""Classes of errors, of three digits each as a reader tells five colours apart, and their colours."""



@frozen
class Dumbbell:
    """A row a problem, from the best outside method to the study's first, sorted by their ratio; errors as colours.

    The best is the quickest that did not fail; where there is a ladder, its last rung counts. With `every`, all methods
    have a row under the name of the problem, with a point a rung.

    Attributes
    ----------
    error, work : str
        Names in the results' errors and `WORK`.
    problems : sequence of str, optional
        Which; all by default.
    every : bool
    """

    error: str
    work: str
    problems: Sequence[str] | None = None
    every: bool = False

    @property
    def name(self) -> str:
        """Of the file."""
        return f"{'every' if self.every else 'dumbbell'}-{self.work}"

    def draw(self, results: Results) -> Figure:
        """The matplotlib figure.

        Parameters
        ----------
        results : Results

        Raises
        ------
        ImportError, ValueError
            Without matplotlib; if the error, the work or a problem is none of the results'.
        """
        results.check(self.error, self.work)
        problems = some("problems", self.problems, results.problems)
        lines = self._all_methods(results, problems) if self.every else self._best(results, problems)
        size = {"height": 1.2 + (1.2 if self.every else 1.5) * LINE * len(lines), "width": 7.4 if self.every else 9.0}
        figure, (axes,) = panels(1, 1, results.title, **size)
        for k, (_, rows, _) in enumerate(lines):
            placed = [(row.work(self.work), -k) for row in rows]
            axes.plot(*zip(*placed or [(math.nan, -k)]), color="0.75", linewidth=2.0, zorder=1)
            for row, point in zip(rows, placed):
                marker = "o" if row.outside else "D"
                colour = next(colour for _, most, colour in ACCURACY if not row.errors[self.error] > most)
                axes.plot(*point, marker, color=colour, markersize=7, markeredgecolor="white")
            if len(rows) == 2 and not self.every:
                # On the side where no line goes.
                side = -1 if placed[1] < placed[0] else 1
                where = {"ha": "right" if side < 0 else "left", "va": "center", "fontsize": "x-small", "color": "0.35"}
                axes.annotate(rows[1].method, placed[1], (7 * side, 0), textcoords="offset points", **where)
            axes.annotate(lines[k][2], (1.01, -k), xycoords=("axes fraction", "data"), va="center", fontsize="small")
        axes.set_xscale("log")
        axes.margins(x=0.06)
        if not self.every:
            named = [[(row.work(self.work), row.method) for row in rows] for _, rows, _ in lines]
            axes.set_xlim(*_room(axes.get_xlim(), named))
        axes.set_ylim(0.6 - len(lines), 0.6)
        axes.set_yticks(range(0, -len(lines), -1), [name for name, _, _ in lines], fontsize="small")
        for label, (_, rows, said) in zip(axes.get_yticklabels(), lines):
            label.set_weight("normal" if rows or said else "bold")
        axes.set_xlabel(WORK[self.work].label)
        tidy(axes)
        axes.grid(axis="y", visible=False)
        self._key(axes)
        return figure

    def _best(self, results: Results, problems: Sequence[str]) -> list[tuple[str, list[Row], str]]:
        """(problem, ours and the best outside one, who is quicker), sorted by their ratio."""
        found = []
        for problem in problems:
            rows = [row for row in results.of(problem=problem) if not row.failed]
            last = max((row.rung for row in rows if not math.isnan(row.rung)), default=math.nan)
            rows = [row for row in rows if row.rung == last or math.isnan(row.rung)]
            ours = [row for row in rows if not row.outside][:1]
            best = sorted((row for row in rows if row.outside), key=lambda row: row.work(self.work))[:1]
            ratio = best[0].work(self.work) / ours[0].work(self.work) if best and ours else math.nan
            much = f"{max(ratio, 1.0 / ratio):.{1 if 0.1 < ratio < 10.0 else 0}f}×"
            said = f"{much} quicker" if ratio >= 1.0 else f"{much} slower" if ratio < 1.0 else "no rival"
            found.append((math.inf if math.isnan(ratio) else -ratio, (problem, ours + best, said)))
        return [line for _, line in sorted(found, key=lambda pair: pair[0])]

    def _all_methods(self, results: Results, problems: Sequence[str]) -> list[tuple[str, list[Row], str]]:
        """A line without rows for each problem, then its methods, the quickest first."""
        lines: list[tuple[str, list[Row], str]] = []
        for problem in problems:
            rows = results.of(problem=problem)
            groups = {row.method: [each for each in rows if each.method == row.method] for row in rows}
            lines.append((problem, [], ""))
            for method in sorted(groups, key=lambda m: min(self._of(row) for row in groups[m])):
                said = ", ".join(dict.fromkeys(row.failure for row in groups[method] if row.failed))
                lines.append((method, [row for row in groups[method] if not row.failed], said))
        return lines

    def _of(self, row: Row) -> float:
        return math.inf if row.failed else row.work(self.work)

    def _key(self, axes: Axes) -> None:
        """Below the panel: which mark is whose, and what the colours mean."""
        classes = [(name, "s", colour) for name, _, colour in ACCURACY]
        marks = [("ours", "D", "0.3"), ("theirs, error:", "o", "0.3"), *classes]
        handles = [axes.plot([], [], mark, color=colour, label=name)[0] for name, mark, colour in marks]
        axes.figure.legend(handles=handles, loc="outside lower left", ncols=len(handles), frameon=False,
                           fontsize="small", handletextpad=0.1, columnspacing=1.2)  # fmt: skip


def _room(limits: tuple[float, float], lines: Sequence[Sequence[tuple[float, str]]]) -> tuple[float, float]:
    """Limits of a logarithmic axis that leave room for the name of each line's second point, outside of the line."""
    low, high = limits
    # A letter of small print takes so much of a panel of seven inches; more room makes it wider in the axis' terms.
    for _ in range(5):
        letter = (high / low) ** 0.0082
        for (own, _), (x, name) in (line for line in lines if len(line) == 2):
            end = x * letter ** math.copysign(len(name) + 2, x - own)
            low, high = min(low, end), max(high, end)
    return low, high


