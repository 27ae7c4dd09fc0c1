"""The order of the Taylor predictor: which one is cheapest, which one the cost model chooses, and what f(n) is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import continuation
from continuation.chart import END_POINT, Lines, Problem, Results, Row, Study, Table, orders, reference, traced
from continuation.chart.catalogue import Size
from continuation.controllers import SeriesRange
from continuation.predictors import Taylor
from continuation.predictors.taylor import best_order
from problems import lcp
from problems.charts.families import planted
from problems.charts.subjects import bratu, chandrasekhar

ACCURACY = 1e-5
"""That of the preset SERIES."""

BUDGET = continuation.Budget(steps=500)


def studies(size: Size, compare: bool) -> Sequence[Study]:
    """Orders from 4 to 30 on dense, banded and KKT paths of several sizes."""
    sizes = {"smoke": (10,), "moderate": (10, 300), "full": (10, 30, 100, 300, 1000)}[size]
    rungs = {"smoke": (6, 12), "moderate": (6, 10, 13, 16, 20, 30), "full": tuple(range(4, 31, 2))}[size]
    problems = [
        *(chandrasekhar(n) for n in sizes),
        *(_kkt(n) for n in sizes),
        *(bratu(n) for n in {"smoke": (), "moderate": (100,), "full": (100, 1000)}[size]),
    ]
    accuracies = {"smoke": (1e-5,), "moderate": (1e-5,), "full": (1e-3, 1e-5, 1e-8)}[size]
    methods = [
        traced(f"{kind}, accuracy {accuracy:g}", predictor=Taylor(accuracy=accuracy, rational=rational), **_REST)
        for accuracy in accuracies
        for kind, rational in (("series", False), ("Pade", True))
    ]
    return [
        Study(
            name="order",
            title="Order of the Taylor predictor against work",
            problems=problems,
            methods=methods,
            ladder=orders(*rungs),
            errors=(END_POINT,),
            work=("seconds", "factorizations", "solves"),
            figures=[Lines("rung", "seconds", chosen=chosen)],
            tables={"Cost model": cost_model},
            repeats={"smoke": 0, "moderate": 1, "full": 5}[size],
            patience=0.6,
        )
    ]


_REST: dict[str, Any] = {"corrector": continuation.SERIES.corrector, "controller": SeriesRange(), "budget": BUDGET}


def unknowns(row: Row) -> int:
    """The size that `best_order` takes: all components of the point, which for a KKT path are 3n + 1."""
    return 3 * row.n + 1 if row.family.startswith("KKT") else row.n + 1


def chosen(row: Row) -> float:
    """The order that the library takes where none is given."""
    return float(best_order(unknowns(row), ACCURACY))


def _kkt(n: int) -> Problem:
    subject = lcp.KKTHomotopy(planted("semidefinite", n, 0))
    return Problem(f"KKT, n = {n}", subject, reference(subject), n=n, family="KKT (dense)")


def cost_model(results: Results) -> Table:
    """One line a problem: what a step of the last method costs, which order the library chooses, which was fastest.

    ``seconds = b (f + K)`` at order K, fitted by least squares.
    """
    lines = []
    for problem in results.problems:
        rows = [row for row in results.of(problem=problem, method=results.methods[-1]) if not row.failed]
        cost = np.array([row.seconds / row.counts.accepted for row in rows])
        # Relative residuals: the short steps of low orders are as many as the long ones of high orders.
        slope, constant = np.polyfit([row.rung for row in rows], cost, 1, w=1.0 / cost)
        best = min(rows, key=lambda row: row.seconds)
        N, choice = unknowns(rows[0]), chosen(rows[0])
        taken = min(rows, key=lambda row: abs(row.rung - choice))
        fit = float(constant / slope), float(1e6 * slope)
        lines.append((problem, N, *fit, int(choice), int(best.rung), taken.seconds / best.seconds))
    return Table(("problem", "N", "f", "b (us)", "order chosen", "fastest order", "chosen over fastest"), lines)
