"""Speed against accuracy: studies of problems x methods x a ladder, with tables and pictures.

A study of a homotopy in ten lines::

    from continuation import chart
    from continuation.predictors import Hermite, Tangent

    study = chart.Study(
        name="mine",
        problems=[chart.Problem("mine", MyHomotopy(), truth=chart.reference(MyHomotopy()))],
        methods=[chart.traced("Hermite", predictor=Hermite()), chart.traced("tangent", predictor=Tangent())],
        ladder=chart.longest_steps(1.0, 0.3, 0.1),
        errors=[chart.CURVE_DISTANCE],
    )
    results = chart.run(study)
    print(chart.summary(results).text())
    chart.Lines("curve_distance", "factorizations").draw(results).savefig("mine.png")
"""

from continuation.chart.model import (
    Answer,
    Failure,
    Method,
    Problem,
    Rung,
    Truth,
    longest_steps,
    reference,
    tolerances,
    traced,
)
from continuation.chart.pictures import Dumbbell, Lines, Profile
from continuation.chart.results import WORK, Results, Row, excess, read, write
from continuation.chart.run import run
from continuation.chart.study import CURVE_DISTANCE, END_POINT, Error, Study, observed
from continuation.chart.table import Table, failures, solved, summary

__all__ = [
    "CURVE_DISTANCE", "END_POINT", "WORK", "Answer", "Dumbbell", "Error", "Failure", "Lines", "Method", "Problem",
    "Profile", "Results", "Row", "Rung", "Study", "Table", "Truth", "excess", "failures", "longest_steps", "observed",
    "read", "reference", "run", "solved", "summary", "tolerances", "traced", "write",
]  # fmt: skip
