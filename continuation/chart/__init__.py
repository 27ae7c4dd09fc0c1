"""Speed against accuracy: studies of problems x methods x a ladder, their tables, files and figures.

A plug-in author charts a homotopy of their own in ten lines::

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
    print(chart.runs(results).text())
    chart.draw(results, "curve_distance", "factorizations").savefig("mine.png")
"""

from continuation.chart.draw import Precision, draw
from continuation.chart.errors import (
    ARCLENGTH,
    CURVE_DISTANCE,
    END_POINT,
    NATURAL_RESIDUAL,
    TURNING_POINTS,
    Error,
    observed,
)
from continuation.chart.front import excess, on_front
from continuation.chart.ladder import Ladder, Rung, longest_steps, orders, tolerances
from continuation.chart.methods import traced
from continuation.chart.model import Answer, Failure, Method, Problem
from continuation.chart.profile import Profile, draw_profile
from continuation.chart.results import WORK, Results, Row
from continuation.chart.run import run
from continuation.chart.scaling import Scaling, draw_scaling, exponents
from continuation.chart.store import read, write
from continuation.chart.study import Figure, Study
from continuation.chart.sweep import Sweep, draw_sweep
from continuation.chart.table import Table, runs, summary
from continuation.chart.truth import Truth, reference

__all__ = [
    "ARCLENGTH", "CURVE_DISTANCE", "END_POINT", "NATURAL_RESIDUAL", "TURNING_POINTS", "WORK", "Answer", "Error",
    "Failure", "Figure", "Ladder", "Method", "Precision", "Problem", "Profile", "Results", "Row", "Rung", "Scaling",
    "Study", "Sweep", "Table", "Truth", "draw", "draw_profile", "draw_scaling", "draw_sweep", "excess", "exponents",
    "longest_steps", "observed", "on_front", "orders", "read", "reference", "run", "runs", "summary", "tolerances",
    "traced", "write",
]  # fmt: skip
