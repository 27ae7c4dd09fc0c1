"""The work-precision chart: error on x, work on y, both logarithmic, one panel a problem, one line a method."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, inf, log10

from attrs import frozen

from continuation.chart.front import ERROR_FLOOR, coordinates, on_front
from continuation.chart.results import WORK, Results, Row
from continuation.chart.style import Axes, Figure, few_ticks, label, legend_below, line_style, panels, ring, tidy

STRIP = 0.11
"""Width of the strip of failures, as a fraction of the panel."""

PILED = 0.75
"""Where so many of a panel's errors are round-off, errors tell nothing: time is on x instead."""

_FRONT = ring(11)


def draw(
    results: Results,
    error: str,
    work: str,
    *,
    problems: Sequence[str] | None = None,
    methods: Sequence[str] | None = None,
) -> Figure:
    """Draw error against work.

    Runs on the Pareto front have a black ring. Errors that are round-off (at most `ERROR_FLOOR`), if there are any, are
    in a grey band on the left; where most of a panel's are, the panel has seconds on x. Failures have no place on x:
    they are in the strip on the right, at the work that they cost, or on its lower edge where that is less or unknown.

    Parameters
    ----------
    results : Results
    error, work : str
        Names in `results.errors` and `WORK`.
    problems, methods : sequence of str, optional
        Which; all by default.

    Returns
    -------
    matplotlib Figure

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; if the error, the work, a problem or a method is none of the results'.
    """
    results.check(error, work)
    shown = list(problems) if problems is not None else results.problems
    names = list(methods) if methods is not None else results.methods
    for kind, wanted, known in (("problems", shown, results.problems), ("methods", names, results.methods)):
        if not wanted or not set(wanted) <= set(known):
            raise ValueError(f"{kind}: expected some of {', '.join(known)}, found {wanted}")
    figure, axes = panels(len(shown))
    label(axes, results.errors[error], WORK[work].label)
    for name, ax in zip(shown, axes):
        rows = [row for row in results.of(problem=name) if row.method in names]
        (_time_panel if piled(rows, error, work) else _panel)(ax, rows, names, error, work)
        tidy(ax, name)
    legend_below(figure, names, results.title if [results.title] != shown else "", {"Pareto front": _FRONT})
    return figure


@frozen
class Precision:
    """The work-precision chart as a figure of a study."""

    error: str
    work: str

    @property
    def name(self) -> str:
        """Of the file."""
        return f"{self.error}-{self.work}"

    def draw(self, results: Results) -> Figure:
        """See `draw`."""
        return draw(results, self.error, self.work)


def piled(rows: Sequence[Row], error: str, work: str) -> bool:
    """Whether nearly all errors of a panel are round-off."""
    found = [point[0] for row in rows if (point := coordinates(row, error, work)) is not None]
    return bool(found) and sum(e <= ERROR_FLOOR for e in found) >= PILED * len(found)


def _time_panel(axes: Axes, rows: Sequence[Row], names: Sequence[str], error: str, work: str) -> None:
    """Work against time, where the error is round-off whatever is done; rows of methods where time is the work."""
    timed, failures = work == "seconds", []
    for k, name in enumerate(names):
        own = [row for row in rows if row.method == name]
        placed = [
            (row.seconds, -k if timed else row.work(work)) for row in own if coordinates(row, error, work) is not None
        ]
        if placed:
            axes.plot(*zip(*placed), **{**line_style(k), "linestyle": "none"})
        failures += [(k, -k if timed else inf if row.spared else row.work(work)) for row in own if row.failed]
    axes.set_xscale("log")
    axes.margins(x=0.08, y=0.08)
    few_ticks(axes.xaxis, beside=True)
    if timed:
        axes.set_yticks([])
        axes.set_ylabel("a row for each method")
    else:
        axes.set_yscale("log")
        few_ticks(axes.yaxis)
    axes.set_xlabel("seconds (errors are round-off)", fontsize="small")
    _failures(axes, failures, len(names))


def _panel(axes: Axes, rows: Sequence[Row], names: Sequence[str], error: str, work: str) -> None:
    points = {id(row): point for row in rows if (point := coordinates(row, error, work)) is not None}
    found = [e for e, _ in points.values()] or [ERROR_FLOOR]
    band = _Band(min(found), max(found), len(names), sum(e <= ERROR_FLOOR for e in found) / len(found))
    failures = []
    for k, name in enumerate(names):
        own = [row for row in rows if row.method == name]
        placed = [band.place(k, *points[id(row)]) for row in own if id(row) in points]
        if placed:
            axes.plot(*zip(*placed), **line_style(k))
        failures += [(k, inf if row.spared else row.work(work)) for row in own if row.failed]
    front = [band.place(names.index(row.method), *points[id(row)]) for row in on_front(rows, error, work)]
    if front:
        axes.plot(*zip(*front), zorder=1, **_FRONT)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(y=0.08)
    few_ticks(axes.yaxis)
    band.mark(axes)
    _failures(axes, failures, len(names))


@frozen
class _Band:
    """The left part of a panel, where errors are round-off: there a point's x is the column of its method.

    Smallest and largest are errors in the panel, `count` its methods, `fraction` what part of the points is in the
    band; where that is 0 there is no band.
    """

    smallest: float
    largest: float
    count: int
    fraction: float

    @property
    def _decades(self) -> float:
        """Of errors beyond round-off, two at least."""
        return max(2.0, log10(self.largest / ERROR_FLOOR) + 0.5)

    @property
    def _share(self) -> float:
        """Of the panel's width: the fraction of the points, between one and two thirds."""
        return min(max(self.fraction, 1.0 / 3.0), 2.0 / 3.0)

    @property
    def _left(self) -> float:
        return float(ERROR_FLOOR * 10.0 ** (-self._decades * self._share / (1.0 - self._share)))

    def place(self, k: int, error: float, work: float) -> tuple[float, float]:
        """Where to draw a point of method k."""
        if error > ERROR_FLOOR:
            return error, work
        return float(self._left * (ERROR_FLOOR / self._left) ** ((k + 0.6) / (self.count + 0.2))), work

    def mark(self, axes: Axes) -> None:
        """Set the axis; shade the band and name it, without ticks in it."""
        from matplotlib.ticker import FixedLocator, LogFormatterSciNotation, NullLocator

        if self.fraction > 0.0:
            first, last = round(log10(ERROR_FLOOR)), floor(log10(ERROR_FLOOR) + self._decades)
            stride = 1 + (last - first) // round(6.0 * (1.0 - self._share))
            axes.set_xlim(self._left, ERROR_FLOOR * 10.0**self._decades)
        else:
            first, last = floor(log10(self.smallest) - 0.1), ceil(log10(self.largest) + 0.1)
            stride = 1 + (last - first) // 6
            axes.set_xlim(10.0**first, 10.0**last)
        axes.xaxis.set_major_locator(FixedLocator([10.0**k for k in range(first, last + 1, stride)]))
        axes.xaxis.set_major_formatter(LogFormatterSciNotation())
        axes.xaxis.set_minor_locator(NullLocator())
        if self.fraction == 0.0:
            return
        axes.axvspan(self._left, ERROR_FLOOR, color="0.94", linewidth=0, zorder=0)
        middle = (self._left * ERROR_FLOOR) ** 0.5
        axes.annotate(
            "round-off", (middle, 0.0), (0, -3), ("data", "axes fraction"), "offset points", fontsize="x-small",
            ha="center", va="top",
        )  # fmt: skip


def _failures(axes: Axes, failures: Sequence[tuple[int, float]], count: int) -> None:
    strip = axes.inset_axes((1.02, 0.0, STRIP, 1.0), sharey=axes)
    strip.set_facecolor("0.94")
    strip.spines[["top", "right", "left", "bottom"]].set_visible(False)
    strip.xaxis.set_visible(False)
    strip.yaxis.set_visible(False)
    strip.set_xlim(-1.0, float(count))
    strip.set_title("failed", fontsize="x-small", pad=2)
    # What raised has no counts: at the lower edge.
    lowest = axes.get_ylim()[0]
    for k, cost in failures:
        if cost < inf:
            strip.plot([k], [max(cost, lowest)], clip_on=False, **{**line_style(k), "linestyle": "none"})
    # What a budget had not sufficed for at a smaller size: at the upper edge, where that is now.
    axes.set_ylim(axes.get_ylim())
    for k in {k for k, cost in failures if cost == inf}:
        strip.plot([k], [axes.get_ylim()[1]], clip_on=False, **{**line_style(k), "linestyle": "none"})
