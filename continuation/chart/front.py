"""The Pareto front of a problem: the runs that no other run beats in both error and work."""

from __future__ import annotations

import math
from collections.abc import Sequence

from continuation.chart.results import Results, Row

ERROR_FLOOR = 1e-13
"""Errors below this are round-off, and count as equal."""


def coordinates(row: Row, error: str, work: str) -> tuple[float, float] | None:
    """(error, work) of a run that succeeded, the error to three digits and not below `ERROR_FLOOR`; None for others.

    Errors that differ in the fourth digit say the same: neither run is better for it.
    """
    value = row.errors[error]
    if row.failed or not math.isfinite(value):
        return None
    return max(float(f"{value:.2e}"), ERROR_FLOOR), row.work(work)


def on_front(rows: Sequence[Row], error: str, work: str) -> list[Row]:
    """The rows of one problem that no other row beats, by falling error.

    Parameters
    ----------
    rows : sequence of Row
    error, work : str
        Names in `Row.errors` and `WORK`.
    """
    points = [(point, row) for row in rows if (point := coordinates(row, error, work)) is not None]
    best = [
        (point, row)
        for point, row in points
        if not any(e <= point[0] and w <= point[1] and (e, w) != point for (e, w), _ in points)
    ]
    return [row for _, row in sorted(best, key=lambda pair: (-pair[0][0], pair[0][1]))]


def excess(results: Results, error: str, work: str) -> dict[tuple[str, str, float], float]:
    """How many times the work of the best run that is at least as accurate; 1 on the front, infinite for failures.

    Keyed by (problem, method, rung); a method without a rung has the key's last entry 0.

    Parameters
    ----------
    results : Results
    error, work : str
        Names in `results.errors` and `WORK`.

    Raises
    ------
    ValueError
        If the error or the work is none of the results'.
    """
    results.check(error, work)
    found = {}
    for problem in results.problems:
        rows = results.of(problem=problem)
        points = [point for row in rows if (point := coordinates(row, error, work)) is not None]
        for row in rows:
            point = coordinates(row, error, work)
            key = (problem, row.method, 0.0 if math.isnan(row.rung) else row.rung)
            if point is None:
                found[key] = math.inf
                continue
            least = min(w for e, w in points if e <= point[0])
            found[key] = point[1] / least
    return found
