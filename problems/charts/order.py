"""The order of the Taylor predictor: which one is cheapest, which one the cost model chooses, and what f(n) is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from attrs import frozen

import continuation
from continuation.chart import END_POINT, Problem, Results, Row, Study, Sweep, Table, orders, reference, traced
from continuation.chart.catalogue import Size
from continuation.chart.style import Figure, legend_below, line_style, panels, tidy
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
            figures=(Sweep("seconds", chosen), Sweep("factorizations"), CostModel()),
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


@frozen
class CostModel:
    """What a step costs against the order K: ``seconds = b (f + K)``, fitted for each problem."""

    name: str = "cost-model"

    def fits(self, results: Results, method: str) -> dict[str, tuple[float, float]]:
        """(f, b in seconds) for each problem, by least squares over the orders."""
        found = {}
        for problem in results.problems:
            rows = [row for row in results.of(problem=problem, method=method) if not row.failed]
            if len(rows) >= 2:
                K = np.array([row.rung for row in rows])
                cost = np.array([row.seconds / row.counts.accepted for row in rows])
                # Relative residuals: the short steps of low orders are as many as the long ones of high orders.
                slope, constant = np.polyfit(K, cost, 1, w=1.0 / cost)
                found[problem] = (float(constant / slope), float(slope))
        return found

    def table(self, results: Results) -> Table:
        """One line a problem: the fit, the order that the library chooses and the one that was fastest."""
        method = results.methods[-1]
        lines = []
        for problem, (f, slope) in self.fits(results, method).items():
            rows = [row for row in results.of(problem=problem, method=method) if not row.failed]
            best = min(rows, key=lambda row: row.seconds)
            N, choice = unknowns(rows[0]), chosen(rows[0])
            taken = min(rows, key=lambda row: abs(row.rung - choice))
            lines.append((problem, N, f, 1e6 * slope, int(choice), int(best.rung), taken.seconds / best.seconds))
        head = ("problem", "N", "f", "b (us)", "order chosen", "fastest order", "chosen over fastest")
        return Table(head, lines)

    def draw(self, results: Results) -> Figure:
        """Seconds a step against the order, with the fits."""
        method = results.methods[-1]
        figure, (axes,) = panels(1, height=4.0)
        figure.set_size_inches(6.5, 5.4)
        labels = []
        for k, (problem, (f, slope)) in enumerate(self.fits(results, method).items()):
            rows = [row for row in results.of(problem=problem, method=method) if not row.failed]
            K = np.array([row.rung for row in rows])
            axes.plot(K, [row.seconds / row.counts.accepted for row in rows], **{**line_style(k), "linestyle": "none"})
            axes.plot(K, slope * (f + K), **{**line_style(k), "marker": ""})
            labels.append(f"{problem}: f = {f:.1f}")
        axes.set_yscale("log")
        axes.set_xlabel("order K")
        axes.set_ylabel("time a step (s)")
        tidy(axes, f"Cost of a step, {method}: points measured, lines b (f + K)")
        legend_below(figure, labels, "")
        return figure
