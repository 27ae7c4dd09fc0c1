"""What a study takes: ladders, and what it refuses."""

import math

import pytest

from continuation import chart
from continuation.predictors import Hermite
from problems.bifurcation import Circle
from problems.charts.subjects import cosine


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"methods": [chart.traced("a")] * 2}, "methods: expected a list of some, each with a name of its own"),
        ({"problems": []}, r"problems: expected a list of some, .* found \[\]"),
        ({"problems": cosine(2)}, "problems: expected a list of some"),
        ({"problems": [Circle()]}, "problems: expected a list of some"),
        ({"errors": {}}, "errors"),
        ({"ladder": ()}, "ladder"),
        *(({"ladder": [rung]}, "ladder: expected a") for rung in (-1.0, "a", math.inf)),
        ({"work": ("flops",)}, "work: expected some of factorizations, .*'flops'"),
    ],
    ids=["twice", "none", "no list", "no problem", "no error", "no rung", "negative", "text", "infinite", "no work"],
)
def test_a_study_refuses_what_is_none(change, complaint):
    whole = {"problems": [cosine(2)], "methods": [chart.traced("a")]}
    with pytest.raises((TypeError, ValueError), match=complaint):
        chart.Study(name="s", **{**whole, **change})


def test_a_misspelt_option_is_refused_at_once():
    said = r"predictr: expected one of the options box, budget, .*; did you mean predictor\?"
    with pytest.raises(TypeError, match=said):
        chart.traced("a", predictr=Hermite())
