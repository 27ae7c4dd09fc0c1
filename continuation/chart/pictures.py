"""Pictures of a study: lines, profiles, dumbbells, with names instead of legends and outside methods in grey."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.chart.panels import (
    LINE,
    Axes,
    Figure,
    looks_of,
    name_ends,
    panels,
    plain_ticks,
    some,
    tidy,
    to_round_off,
)
from continuation.chart.results import WORK, Results, Row, by_size, exponents, ratios

Line = tuple[str, dict[str, Any], Sequence[tuple[float, float]]]
"""Name, style, points."""

Rows = tuple[str, Sequence[Row], str]
"""Name, runs, remark."""


def _names(value: str | Sequence[str]) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)


@frozen
class Lines:
    """Work against an error or the size ``"n"``, both logarithmic: lower is better.

    Errors fall to the right. A panel shows a problem and kind of work, with numbers of failures; for n, a family with
    exponents.

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

    @property
    def name(self) -> str:
        """File name."""
        return "-".join((self.across, *self.work))

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
        for work in self.work:
            results.check(None if sizes else self.across, work)
        problems = some("problems", self.problems, results.problems)
        looks = looks_of(results, some("methods", self.methods, results.methods))
        subjects = results.families if sizes else problems
        columns = len(self.work) if len(self.work) > 1 else min(2, len(subjects))
        figure, axes = panels(len(subjects) * len(self.work), columns, results.title)
        for k, ax in enumerate(axes):
            subject, work = subjects[k // len(self.work)], self.work[k % len(self.work)]
            lines = (self._by_size if sizes else self._by_error)(results, subject, work, looks)
            ax.set_title(subject, fontsize="medium", loc="left")
            ax.set_xlabel(("size n" if sizes else results.errors[self.across]) if k + columns >= len(axes) else "")
            ax.set_ylabel(WORK[work].label)
            self._panel(ax, lines)
        return figure

    def _by_error(self, results: Results, problem: str, work: str, looks: dict[str, Any]) -> list[Line]:
        lines: list[Line] = []
        for method, look in looks.items():
            rows = results.of(problem=problem, method=method)
            points = [point for row in rows if (point := row.placed(self.across, work)) is not None]
            failed = sum(row.failed for row in rows)
            said = f" ({failed} of {len(rows)} failed)" if failed else ""
            lines += [(method + said, look, points)] if rows else []
        return lines

    def _by_size(self, results: Results, family: str, work: str, looks: dict[str, Any]) -> list[Line]:
        powers = {method: power for (of, method), power in exponents(results, work).items() if of == family}
        named = {m: f"{m}, $n^{{{powers[m]:.1f}}}$" if math.isfinite(powers[m]) else m for m in looks}
        return [(named[m], look, by_size(results, family, m, work)) for m, look in looks.items()]

    def _panel(self, axes: Axes, lines: Sequence[Line]) -> None:
        for _, look, points in lines:
            if points:
                axes.plot(*zip(*points), **look)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(x=0.06, y=0.08)
        if self.across != "n":
            to_round_off(axes)
        plain_ticks(axes.yaxis)
        tidy(axes)
        name_ends(axes, [(*points[-1], name, look["color"]) for name, look, points in lines if points])
        absent = [name.split(" (")[0] for name, _, points in lines if not points and "failed" in name]
        if absent:
            text = f"failed: {', '.join(absent)}"
            axes.annotate(text, (0.02, 0.02), xycoords="axes fraction", fontsize="x-small", color="0.4")


@frozen
class Profile:
    """Performance profile: fraction of runs that a method solves within a factor of the least work.

    Right edge: fraction solved at all; left edge: solved best.

    Dolan and More, Benchmarking optimization software with performance profiles, Math. Program. 91, 2002.

    Attributes
    ----------
    work : str
        One of `WORK`.
    """

    work: str

    @property
    def name(self) -> str:
        """File name."""
        return f"profile-{self.work}"

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
        found = ratios(results, self.work)
        figure, (axes,) = panels(1, 1, results.title, height=max(3.2, LINE * len(found) + 1.2))
        everything = np.concatenate(list(found.values()))
        widest = 10.0 ** max(1, np.ceil(np.log10(everything[np.isfinite(everything)].max(initial=1.0))))
        ends = []
        for method, look in looks_of(results, results.methods).items():
            values = np.sort(found[method])
            finite = values[np.isfinite(values)]
            # Steps from (1, fraction best) to the edge.
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


ACCURACY = (
    ("≤ 1e-12", 1e-12, "#08306b"),
    ("1e-9", 1e-9, "#2171b5"),
    ("1e-6", 1e-6, "#6baed6"),
    ("1e-3", 1e-3, "#fdae6b"),
    ("more", math.inf, "#d94801"),
)
"""Error classes of three digits each (readers tell five colours apart), and colours."""


@frozen
class Dumbbell:
    """Best outside method against ours, one row per problem, sorted by ratio; colours show errors.

    Best: quickest without failure, on the last rung. With `every`, each method has a row, each rung a point.

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

    @property
    def name(self) -> str:
        """File name."""
        return f"{'every' if self.every else 'dumbbell'}-{self.work}"

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
        results.check(self.error, self.work)
        problems = some("problems", self.problems, results.problems)
        lines = self._all_methods(results, problems) if self.every else self._best(results, problems)
        height, width = (1.2, 7.4) if self.every else (1.5, 9.0)
        figure, (axes,) = panels(1, 1, results.title, height=1.2 + height * LINE * len(lines), width=width)
        for k, (_, rows, said) in enumerate(lines):
            placed = [(row.work(self.work), -k) for row in rows]
            axes.plot(*zip(*placed or [(math.nan, -k)]), color="0.75", linewidth=2.0, zorder=1)
            for row, point in zip(rows, placed):
                colour = next(colour for _, most, colour in ACCURACY if not row.errors[self.error] > most)
                axes.plot(*point, "o" if row.outside else "D", color=colour, markersize=7, markeredgecolor="white")
            if len(rows) == 2 and not self.every:
                # On the free side.
                side = -1 if placed[1] < placed[0] else 1
                where = {"ha": "right" if side < 0 else "left", "va": "center", "fontsize": "x-small", "color": "0.35"}
                axes.annotate(rows[1].method, placed[1], (7 * side, 0), textcoords="offset points", **where)
            axes.annotate(said, (1.01, -k), xycoords=("axes fraction", "data"), va="center", fontsize="small")
        axes.set_xscale("log")
        # Margins for names: a letter takes .009 of the panel.
        letters = 0 if self.every else max((len(rows[-1].method) for _, rows, _ in lines if rows), default=0)
        beside = min(0.04 + 0.009 * letters, 0.4)
        axes.margins(x=beside / (1.0 - 2.0 * beside))
        axes.set_ylim(0.6 - len(lines), 0.6)
        axes.set_yticks(range(0, -len(lines), -1), [name for name, _, _ in lines], fontsize="small")
        for label, (_, rows, said) in zip(axes.get_yticklabels(), lines):
            label.set_weight("normal" if rows or said else "bold")
        axes.set_xlabel(WORK[self.work].label)
        tidy(axes)
        axes.grid(axis="y", visible=False)
        marks = [("ours", "D", "0.3"), ("theirs, error:", "o", "0.3"), *((name, "s", c) for name, _, c in ACCURACY)]
        handles = [axes.plot([], [], mark, color=colour, label=name)[0] for name, mark, colour in marks]
        figure.legend(handles=handles, loc="outside lower left", ncols=len(handles), frameon=False, fontsize="small",
                      handletextpad=0.1, columnspacing=1.2)  # fmt: skip
        return figure

    def _best(self, results: Results, problems: Sequence[str]) -> list[Rows]:
        """(problem, ours and best outside, verdict), sorted by ratio."""
        found = []
        for problem in problems:
            rows = [row for row in results.of(problem=problem) if not row.failed]
            last = max((row.rung for row in rows if not math.isnan(row.rung)), default=math.nan)
            rows = [row for row in rows if row.rung == last or math.isnan(row.rung)]
            ours = [row for row in rows if not row.outside][:1]
            best = sorted((row for row in rows if row.outside), key=lambda row: row.work(self.work))[:1]
            ratio = best[0].work(self.work) / ours[0].work(self.work) if best and ours else math.nan
            much = f"{max(ratio, 1.0 / ratio):.{1 if 0.1 < ratio < 10.0 else 0}f}×"
            alone = "no rival" if ours else "ours failed"
            said = f"{much} quicker" if ratio >= 1.0 else f"{much} slower" if ratio < 1.0 else alone
            found.append((math.inf if math.isnan(ratio) else -ratio, (problem, ours + best, said)))
        return [line for _, line in sorted(found, key=lambda pair: pair[0])]

    def _all_methods(self, results: Results, problems: Sequence[str]) -> list[Rows]:
        """Per problem a heading, then methods, quickest first."""
        lines: list[Rows] = []
        for problem in problems:
            whole = sorted(results.of(problem=problem), key=lambda row: (row.failed, row.work(self.work)))
            lines.append((problem, [], ""))
            for method in dict.fromkeys(row.method for row in whole):
                rows = results.of(problem=problem, method=method)
                said = ", ".join(dict.fromkeys(row.failure for row in rows if row.failed))
                lines.append((method, [row for row in rows if not row.failed], said))
        return lines
