"""What is read off results: the Pareto front, the excess over it, ratios to the best, exponents of the size."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from continuation.arrays import Array
from continuation.chart.results import Results, Row

FITTED = 3
"""Sizes that a fitted exponent needs at least; it is made to the larger half of them, since costs are asymptotic."""


def on_front(rows: Sequence[Row], error: str, work: str) -> list[Row]:
    """The Pareto front: the rows of one problem that no other row beats in error and work, by falling error.

    Parameters
    ----------
    rows : sequence of Row
    error, work : str
        Names in `Row.errors` and `WORK`.
    """
    points = [(point, row) for row in rows if (point := row.placed(error, work)) is not None]
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
        placed = [(row, row.placed(error, work)) for row in results.of(problem=problem)]
        points = [point for _, point in placed if point is not None]
        for row, point in placed:
            least = math.nan if point is None else min(w for e, w in points if e <= point[0])
            key = (problem, row.method, 0.0 if math.isnan(row.rung) else row.rung)
            found[key] = math.inf if point is None else point[1] / least
    return found


def ratios(results: Results, work: str, family: str | None = None) -> dict[str, Array]:
    """For each method, a number a problem and rung: its work over the least of all methods; infinite where it failed.

    Methods without a rung take part in each.

    Parameters
    ----------
    results : Results
    work : str
        One of `WORK`.
    family : str, optional
        Only its problems; all by default.
    """
    results.check(work=work)
    rows = results.of(family=family)
    rungs = sorted({row.rung for row in rows if not math.isnan(row.rung)}) or [math.nan]
    cost = {
        (row.problem, rung, row.method): math.inf if row.failed else row.work(work)
        for row in rows
        for rung in (rungs if math.isnan(row.rung) else [row.rung])
    }
    cases = list(dict.fromkeys((problem, rung) for problem, rung, _ in cost))
    table = np.array([[cost.get((*case, method), math.inf) for case in cases] for method in results.methods])
    least = table.min(axis=0)
    # Where all failed the least is infinite, and the quotient is to be.
    least[np.isinf(least)] = 1.0
    return dict(zip(results.methods, table / least))


def by_size(results: Results, family: str, method: str, work: str) -> list[tuple[float, float]]:
    """(n, mean work) of the runs that succeeded, by n."""
    rows = [row for row in results.of(family=family, method=method) if not row.failed]
    sizes = sorted({row.n for row in rows})
    return [(float(n), float(np.mean([row.work(work) for row in rows if row.n == n]))) for n in sizes]


def exponents(results: Results, work: str) -> dict[tuple[str, str], float]:
    """The exponent p of work ~ n^p for each (family, method), by least squares on logarithms; NaN below `FITTED` sizes.

    A size with several runs counts with their mean; failures are left out.

    Parameters
    ----------
    results : Results
    work : str
        One of `WORK`.

    Raises
    ------
    ValueError
        If the work is none of the results'.
    """
    results.check(work=work)
    found = {}
    for family in results.families:
        for method in results.methods:
            points = by_size(results, family, method, work)
            upper = np.log(points[-max(FITTED, len(points) // 2) :]).reshape(-1, 2)
            enough = len(upper) >= FITTED
            found[family, method] = float(np.polyfit(upper[:, 0], upper[:, 1], 1)[0]) if enough else math.nan
    return found
