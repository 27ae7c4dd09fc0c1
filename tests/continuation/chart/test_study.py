"""What a study takes: ladders, and what it refuses."""

import math

import numpy as np
import pytest

import continuation
from continuation import chart
from continuation.predictors import Hermite, Taylor
from problems.bifurcation import Circle
from problems.charts.subjects import cosine


def test_the_ladder_of_orders_sets_the_order_and_needs_a_series():
    rung = chart.orders(7).rungs[0]
    assert rung.apply({"predictor": Taylor(accuracy=1e-3)})["predictor"] == Taylor(7, accuracy=1e-3)
    assert rung.apply({"preset": continuation.SERIES})["predictor"].order == 7
    with pytest.raises(TypeError, match="predictor: expected a Taylor predictor"):
        rung.apply({})


@pytest.mark.parametrize("preset", [continuation.DEFAULT, continuation.SERIES], ids=lambda preset: preset.name)
@pytest.mark.parametrize("longest", [3.0, 0.02])
def test_the_ladder_of_longest_steps_is_kept_to_by_every_preset(preset, longest):
    (rung,) = chart.longest_steps(longest).rungs
    path = continuation.trace(cosine(2).subject, **rung.apply({"preset": preset}))
    assert path.success
    # A step is measured along the tangent, the arc that it makes is longer by its curvature.
    assert np.diff(path.arclength).max() <= 1.01 * longest


@pytest.mark.parametrize(
    ("change", "kind", "complaint"),
    [
        ({"methods": [chart.traced("a")] * 2}, ValueError, "methods: expected distinct names, found 'a' twice"),
        ({"problems": []}, ValueError, "problems: expected at least one"),
        ({"problems": cosine(2)}, TypeError, "problems: expected a list"),
        ({"problems": [Circle()]}, TypeError, "problems: expected problems of continuation.chart"),
        ({"errors": ["end_point"]}, TypeError, "errors: expected errors of continuation.chart, found 'end_point'"),
        ({"work": ("flops",)}, ValueError, "work: expected a list of some of factorizations, .*'flops'"),
    ],
    ids=["twice", "none", "no list", "no problem", "no error", "no work"],
)
def test_a_study_refuses_what_is_none(change, kind, complaint):
    whole = {"problems": [cosine(2)], "methods": [chart.traced("a")], "errors": [chart.END_POINT]}
    with pytest.raises(kind, match=complaint):
        chart.Study(name="s", **{**whole, **change})


def test_a_misspelt_option_and_a_bad_rung_are_refused_at_once():
    said = r"predictr: expected one of the options box, budget, .*; did you mean predictor\?"
    with pytest.raises(TypeError, match=said):
        chart.traced("a", predictr=Hermite())
    for bad in ((), (-1.0,), ("a",), (math.inf,)):
        with pytest.raises(ValueError, match="values: expected positive numbers"):
            chart.tolerances(*bad)
