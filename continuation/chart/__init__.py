"""Speed against accuracy: studies of problems x methods x tolerances, with tables and pictures.

A study of a homotopy in ten lines::

    from continuation import chart
    from continuation.predictors import Hermite, Tangent

    study = chart.Study(
        name="mine",
        problems=[chart.Problem("mine", MyHomotopy(), truth=chart.reference(MyHomotopy()))],
        methods=[chart.traced("Hermite", predictor=Hermite()), chart.traced("tangent", predictor=Tangent())],
    )
    results = chart.run(study)
    print(chart.summary(results).text())
    chart.Lines("end_point", "factorizations").draw(results).savefig("mine.png")
"""

from continuation.chart.model import Answer, Method, Problem, Truth, reference, traced
from continuation.chart.pictures import Lines, Profile
from continuation.chart.results import WORK, Results, Row, excess, read, write
from continuation.chart.run import run
from continuation.chart.study import END_POINT, Study
from continuation.chart.table import Table, solved, summary

__all__ = [
    "END_POINT", "WORK", "Answer", "Lines", "Method", "Problem", "Profile", "Results", "Row", "Study", "Table",
    "Truth", "excess", "read", "reference", "run", "solved", "summary", "traced", "write",
]  # fmt: skip
