"""Tables of results, as text and Markdown."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from attrs import frozen

from continuation.chart.results import Results, excess

Cell = str | int | float


@frozen
class Table:
    """Rows under a head.

    Attributes
    ----------
    head : sequence of str
    rows : sequence of sequences
    """

    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]

    def text(self) -> str:
        """Aligned text, numbers to the right."""
        lines = self._aligned()
        rule = ["-" * len(cell) for cell in lines[0]]
        return "\n".join("  ".join(line).rstrip() for line in (lines[0], rule, *lines[1:]))

    def markdown(self) -> str:
        """GitHub Markdown."""
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
    return "" if math.isnan(cell) else f"{cell:.3g}"


def summary(results: Results) -> Table:
    """Successes, failures, and median `excess` of successful runs for each method.

    Parameters
    ----------
    results : Results
    """
    far = [excess(results, next(iter(results.errors)), work) for work in results.work]
    lines: list[tuple[Cell, ...]] = []
    for method in results.methods:
        rows, mine = results.of(method=method), np.array([row.method == method for row in results.rows])
        failures = Counter(row.failure for row in rows if row.failed)
        said = ", ".join(f"{count} {name}" for name, count in failures.items())
        medians = [float(np.median(found)) if (found := t[mine & np.isfinite(t)]).size else math.nan for t in far]
        lines.append((method, f"{len(rows) - failures.total()} of {len(rows)}", said, *medians))
    return Table(("method", "solved", "failures", *results.work), lines)


def solved(results: Results) -> Table:
    """Percentage of runs that each method solves, per family.

    Parameters
    ----------
    results : Results
    """
    lines: list[tuple[Cell, ...]] = []
    for method in results.methods:
        families = [results.of(method=method, family=family) for family in results.families]
        lines.append((method, *(100 * sum(not row.failed for row in rows) // max(len(rows), 1) for rows in families)))
    return Table(("% solved", *results.families), lines)
