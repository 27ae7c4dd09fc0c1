"""Three pictures of a study: lines of work against something, the fraction solved against work, dumbbells.

Names are written at what they name, so that no legend is searched. Methods of the study are in colours, outside ones in
grey.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from attrs import field, frozen
from scipy.optimize import isotonic_regression

from continuation.chart.results import ERROR_FLOOR, WORK, Results, Row, by_size, exponents, ratios
from continuation.plot.drawing import COLOURS, STYLES, require_matplotlib

MARKERS = "os^DvPX<>p"

GREYS = ("0.25", "0.45", "0.6")

LINE = 0.165
"""Inches from one line of small print to the next."""

ACCURACY = (
    ("≤ 1e-12", 1e-12, "#08306b"),
    ("1e-9", 1e-9, "#2171b5"),
    ("1e-6", 1e-6, "#6baed6"),
    ("1e-3", 1e-3, "#fdae6b"),
    ("more", math.inf, "#d94801"),
)
"""Classes of errors, of three digits each as a reader tells five colours apart, and their colours."""

Axes = Any
Figure = Any

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
        problems = _some("problems", self.problems, results.problems)
        methods = _some("methods", self.methods, results.methods)
        looks = _looks(results, methods)
        per = {"n": results.families, "rung": methods}.get(self.across, problems)
        columns = len(self.work) if len(self.work) > 1 else min(2, len(per))
        figure, axes = _panels(len(per) * len(self.work), columns, results.title)
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
            lines.append(Line(problem, _look(k), points, seen))
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
            _to_round_off(axes)
        _plain_ticks(axes.yaxis)
        _tidy(axes)
        ends = [(*line.points[-1], line.name, line.look["color"]) for line in lines if line.points]
        _name_ends(axes, ends)
        absent = [line.name.split(" (")[0] for line in lines if not line.points]
        if absent:
            axes.set_title(f"failed: {', '.join(absent)}", fontsize="x-small", loc="right", color="0.4")


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
        figure, (axes,) = _panels(1, 1, results.title, height=max(3.2, LINE * len(found) + 1.2))
        everything = np.concatenate(list(found.values()))
        # To the power of ten at which all that is ever solved is solved.
        widest = 10.0 ** max(1, np.ceil(np.log10(everything[np.isfinite(everything)].max(initial=1.0))))
        ends = []
        for method, look in _looks(results, results.methods).items():
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
        _tidy(axes)
        _name_ends(axes, ends)
        return figure


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
        problems = _some("problems", self.problems, results.problems)
        lines = self._all_methods(results, problems) if self.every else self._best(results, problems)
        figure, (axes,) = _panels(1, 1, results.title, height=1.2 + (1.2 if self.every else 1.5) * LINE * len(lines))
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
        axes.margins(x=0.2 if not self.every else 0.05)
        axes.set_ylim(0.6 - len(lines), 0.6)
        axes.set_yticks(range(0, -len(lines), -1), [name for name, _, _ in lines], fontsize="small")
        for label, (_, rows, _) in zip(axes.get_yticklabels(), lines):
            label.set_weight("normal" if rows else "bold")
        axes.set_xlabel(WORK[self.work].label)
        _tidy(axes)
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
            said = f"{ratio:.2g}× quicker" if ratio >= 1.0 else f"{1.0 / ratio:.2g}× slower" if ratio < 1.0 else "alone"
            found.append((-math.inf if math.isnan(ratio) else -ratio, (problem, ours + best, said)))
        return [line for _, line in sorted(found, key=lambda pair: pair[0])]

    def _all_methods(self, results: Results, problems: Sequence[str]) -> list[tuple[str, list[Row], str]]:
        """A line without rows for each problem, then its methods, the quickest first."""
        lines: list[tuple[str, list[Row], str]] = []
        for problem in problems:
            rows = results.of(problem=problem)
            groups = {row.method: [each for each in rows if each.method == row.method] for row in rows}
            least = {m: min((r.work(self.work) for r in g if not r.failed), default=math.inf) for m, g in groups.items()}
            lines.append((problem, [], ""))
            for method in sorted(groups, key=least.__getitem__):
                said = ", ".join(dict.fromkeys(row.failure for row in groups[method] if row.failed))
                lines.append((method, [row for row in groups[method] if not row.failed], said))
        return lines

    def _key(self, axes: Axes) -> None:
        """Above the panel: which mark is whose, and what the colours mean."""
        place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "va": "bottom"}
        signs = [("◆ ours   ● theirs     error:", "0.3"), *((f"■ {name}", colour) for name, _, colour in ACCURACY)]
        # As wide as their letters.
        for k, (text, colour) in enumerate(signs):
            before = sum(len(text) + 2 for text, _ in signs[:k])
            axes.annotate(text, (0.0, 1.0), (5.4 * before, 5), color=colour, fontsize="small", **place)


def _some(kind: str, wanted: Sequence[str] | None, known: Sequence[str]) -> Sequence[str]:
    if wanted is None:
        return known
    if not wanted or not set(wanted) <= set(known):
        raise ValueError(f"{kind}: expected some of {', '.join(known)}, found {wanted}")
    return wanted


def _look(k: int, outside: bool = False) -> dict[str, Any]:
    colours = GREYS if outside else COLOURS
    return {
        "color": colours[k % len(colours)],
        "marker": MARKERS[k % len(MARKERS)],
        "linestyle": STYLES[1 + k % 3] if outside else STYLES[k // len(COLOURS) % len(STYLES)],
        "linewidth": 1.5,
        "markersize": 5.5,
        "markeredgecolor": "white",
        "markeredgewidth": 0.5,
    }


def _looks(results: Results, methods: Sequence[str]) -> dict[str, dict[str, Any]]:
    """By method: the k-th of ours, or of the others."""
    outside = {row.method: row.outside for row in results.rows}
    return {m: _look([o for o in methods if outside[o] == outside[m]].index(m), outside[m]) for m in methods}


def _panels(count: int, across: int, title: str, height: float = 3.0) -> tuple[Figure, list[Axes]]:
    """A figure as wide as a page, with `count` panels, `across` of them in a row."""
    require_matplotlib()
    from matplotlib.figure import Figure as Canvas

    down = -(-count // across)
    figure = Canvas(figsize=(7.4 if across == 1 else 5.0 * across, 0.4 + height * down), dpi=110, layout="constrained")
    grid = figure.subplots(down, across, squeeze=False).ravel()
    for unused in grid[count:]:
        unused.remove()
    figure.suptitle(title, fontsize="medium")
    return figure, list(grid[:count])


def _tidy(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(which="major", color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)


def _plain_ticks(axis: Any) -> None:
    """Plain numbers at 1, 2 and 5 of each decade where the axis spans little; the decades otherwise."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    if high <= 300.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high > 8.0 * low else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _to_round_off(axes: Axes) -> None:
    """Errors fall to the right, where round-off is named."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    largest = max(axes.get_xlim()[1], 1e4 * ERROR_FLOOR)
    axes.set_xlim(largest, 0.4 * ERROR_FLOOR)
    axes.xaxis.set_major_locator(LogLocator(numticks=6))
    exponent = round(math.log10(ERROR_FLOOR))
    ticks = [10.0**k for k in range(exponent, math.floor(math.log10(largest)) + 1, 3)]
    axes.set_xticks(ticks)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda e, _: "round-off" if e < 2.0 * ERROR_FLOOR else f"{e:.0e}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _name_ends(axes: Axes, ends: Sequence[tuple[float, float, str, str]]) -> None:
    """Write names (x, y, text, colour) beside the panel, as near to their points as keeps them apart, and tie them."""
    if not ends:
        return
    ends = sorted(ends, key=lambda end: end[1])
    to_panel = axes.transData + axes.transAxes.inverted()
    heights = np.array([to_panel.transform((x, y))[1] for x, y, _, _ in ends])
    # Titles and labels leave three quarters of the figure to its panels.
    rows = axes.get_subplotspec().get_gridspec().nrows
    apart = LINE / (0.75 * axes.figure.get_size_inches()[1] / rows) * np.arange(len(ends))
    places = isotonic_regression(heights - apart).x + apart
    places = np.minimum(np.maximum(places, apart), max(1.0, apart[-1]) - apart[::-1])
    for place, (x, y, text, colour) in zip(places, ends):
        tie = {"arrowstyle": "-", "color": colour, "linewidth": 0.6, "shrinkA": 1.0, "shrinkB": 4.0}
        where: dict[str, Any] = {"textcoords": "axes fraction", "va": "center", "annotation_clip": False}
        axes.annotate(text, (x, y), (1.05, place), fontsize="small", color=colour, arrowprops=tie, **where)
