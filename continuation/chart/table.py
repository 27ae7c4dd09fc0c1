"""Results as tables: text and Markdown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import median

import numpy as np
from attrs import field, frozen

from continuation.chart.measures import by_size, excess, exponents, on_front, ratios
from continuation.chart.results import Results, Row

Cell = str | int | float

ON_FRONT = "*"
"""Marks the runs on the Pareto front."""


def _head(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(names)


def _rows(rows: Iterable[Sequence[Cell]]) -> tuple[tuple[Cell, ...], ...]:
    return tuple(tuple(row) for row in rows)


@frozen
class Table:
    """Rows of cells under a head.

    Attributes
    ----------
    head : tuple of str
    rows : tuple of tuple
        Of text and numbers.
    """

    head: tuple[str, ...] = field(converter=_head)
    rows: tuple[tuple[Cell, ...], ...] = field(converter=_rows)

    def text(self) -> str:
        """Columns aligned, numbers to the right."""
        lines = self._aligned()
        rule = ["-" * len(cell) for cell in lines[0]]
        return "\n".join("  ".join(line).rstrip() for line in (lines[0], rule, *lines[1:]))

    def markdown(self) -> str:
        """A table of GitHub's kind."""
        lines = self._aligned()
        rule = [("-" * (len(c) - 1) + ":") if right else "-" * len(c) for c, right in zip(lines[0], self._numeric())]
        return "\n".join(f"| {' | '.join(line)} |" for line in (lines[0], rule, *lines[1:]))

    def _numeric(self) -> list[bool]:
        return [any(not isinstance(row[k], str) for row in self.rows) for k in range(len(self.head))]

    def _aligned(self) -> list[list[str]]:
        cells = [list(self.head), *([_shown(cell) for cell in row] for row in self.rows)]
        widths = [max(3, *(len(line[k]) for line in cells)) for k in range(len(self.head))]
        right = self._numeric()
        return [[c.rjust(w) if r else c.ljust(w) for c, w, r in zip(line, widths, right)] for line in cells]


def _shown(cell: Cell) -> str:
    if isinstance(cell, str):
        return cell.replace("|", "/")
    if isinstance(cell, int):
        return str(cell)
    if math.isnan(cell):
        return ""
    return "inf" if math.isinf(cell) else f"{cell:.3g}"


def runs(results: Results, failures_only: bool = False) -> Table:
    """One line a run, failures included; the front in the first error and the first work is marked.

    Parameters
    ----------
    results : Results
    failures_only : bool
        Only the runs that failed.
    """
    error, work = next(iter(results.errors)), results.work[0]
    front = {id(row) for p in results.problems for row in on_front(results.of(problem=p), error, work)}
    counts = [name for name in results.rows[0].counts.as_dict() if name != "jacobians"] if results.rows else []
    head = ("problem", "n", "method", results.ladder, "front", "outcome", "turns", *results.errors, *counts, "seconds")
    lines: list[tuple[Cell, ...]] = [
        (row.problem, row.n, row.method, row.rung, ON_FRONT if id(row) in front else "", row.failure or "ok", row.turns,
         *(row.errors[name] for name in results.errors), *(row.counts.as_dict()[name] for name in counts), row.seconds)
        for row in results.rows
        if row.failed or not failures_only
    ]  # fmt: skip
    return Table(head, lines)


def summary(results: Results, error: str | None = None) -> Table:
    """One line a method: runs that succeeded, and how far from the Pareto front they are in each kind of work.

    The excess of a run is its work over that of the best run of the same problem that is at least as accurate: 1 on
    the front. Shown are the median and the largest over the runs that succeeded.

    Parameters
    ----------
    results : Results
    error : str, optional
        By default the first of the results.
    """
    error = next(iter(results.errors)) if error is None else error
    far = {work: excess(results, error, work) for work in results.work}
    head = ["method", "runs", "solved", "failures"]
    for work in results.work:
        head += [f"{work}: median excess", "worst"]
    lines = [_line(method, results.of(method=method), far) for method in results.methods]
    return Table(head, lines)


def _line(method: str, rows: Sequence[Row], far: dict[str, dict[tuple[str, str, float], float]]) -> tuple[Cell, ...]:
    cells: list[Cell] = [method, len(rows), sum(not row.failed for row in rows), _failures(rows)]
    for table in far.values():
        values = [value for (_, name, _), value in table.items() if name == method and math.isfinite(value)]
        cells += [median(values), max(values)] if values else [math.nan, math.nan]
    return tuple(cells)


def _failures(rows: Iterable[Row]) -> str:
    found = [row.failure for row in rows if row.failed]
    return ", ".join(f"{found.count(name)} {name}" for name in dict.fromkeys(found))


def profile(results: Results, work: str = "factorizations") -> Table:
    """One line a family and method: the fraction solved at all, and within 1, 2 and 10 times the best work.

    Parameters
    ----------
    results : Results
    work : str
        One of `WORK`.
    """
    lines: list[tuple[Cell, ...]] = [
        (family, method, values.size, *(float((values <= limit).mean()) for limit in (1.0, 2.0, 10.0)),
         float(np.isfinite(values).mean()))
        for family in results.families
        for method, values in ratios(results, work, family).items()
    ]  # fmt: skip
    return Table(("family", "method", "runs", "best", "within 2", "within 10", "solved"), lines)


def scaling(results: Results, work: str = "factorizations") -> Table:
    """One line a family and method: the work at each size, and the exponent.

    Parameters
    ----------
    results : Results
    work : str
        One of `WORK`.
    """
    sizes = sorted({row.n for row in results.rows})
    lines: list[tuple[Cell, ...]] = []
    for (family, method), power in exponents(results, work).items():
        costs = dict(by_size(results, family, method, work))
        if costs:
            lines.append((family, method, *(costs.get(float(n), math.nan) for n in sizes), round(power, 2)))
    return Table(("family", "method", *(f"n = {n}" for n in sizes), "exponent"), lines)
