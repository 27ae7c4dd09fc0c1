"""What is read off results: the front, profiles, exponents, as tables."""

import math

import pytest
from attrs import evolve

from continuation import chart
from continuation.chart.results import ERROR_FLOOR
from continuation.counts import Counts


def test_profiles_reach_as_far_as_anything_is_solved():
    results = made(("a", 1.0, 1, ""), ("b", 1.0, 700, ""), ("c", 1.0, 1, "jump"))
    (panel,) = chart.Profile("factorizations").draw(results).axes
    assert panel.get_xlim() == (1.0, 1000.0)
    assert [line.get_ydata()[-1] for line in panel.get_lines()] == [1.0, 1.0, 0.0]
    assert {text.get_text() for text in panel.texts} == {"a  100 %", "b  100 %", "c  0 %"}


def made(*points):
    """Results of one problem: (method, error, factorisations, failure)."""
    rows = [
        chart.Row("p", "p", 1, name, False, 1.0, failure, "", {"e": error}, Counts(factorizations=work), 0, 1.0)
        for name, error, work, failure in points
    ]
    return chart.Results("s", "t", "tolerance", {"e": "error"}, ("factorizations",), tuple(rows))


def test_the_front_is_what_nothing_beats():
    results = made(
        ("cheap", 1e-2, 10, ""),
        ("middle", 1e-4, 20, ""),
        ("beaten", 1e-3, 30, ""),
        ("exact", ERROR_FLOOR / 10, 50, ""),
        ("also exact", ERROR_FLOOR / 2, 50, ""),
        ("dearer", ERROR_FLOOR / 100, 60, ""),
        ("failed", 1e-9, 1, "jump"),
    )
    far = dict(zip(results.methods, chart.excess(results, "e", "factorizations").tolist()))
    assert far == {
        "cheap": 1.0, "middle": 1.0, "beaten": 1.5, "exact": 1.0, "also exact": 1.0, "dearer": 1.2, "failed": math.inf
    }  # fmt: skip
    lines = {line[0]: line for line in chart.summary(results).rows}
    assert lines["beaten"][-2:] == (1.5, 1.5)
    assert lines["failed"][1:4] == (1, 0, "1 jump")


def test_profiles_count_failures_as_unsolved():
    results = made(("a", 1.0, 10, ""), ("b", 1.0, 15, ""), ("c", 1.0, 1, "jump"))
    assert {name: values.tolist() for name, values in chart.ratios(results, "factorizations").items()} == {
        "a": [1.0], "b": [1.5], "c": [math.inf]
    }  # fmt: skip
    assert chart.profile(results, "factorizations").rows == [
        ("p", "a", 1, 1.0, 1.0, 1.0, 1.0),
        ("p", "b", 1, 0.0, 1.0, 1.0, 1.0),
        ("p", "c", 1, 0.0, 0.0, 0.0, 0.0),
    ]


def test_exponents_are_fitted_to_the_larger_sizes():
    one = made(("a", 1.0, 1, "")).rows[0]
    sizes = [1, 2, 10, 20, 40]
    rows = tuple(
        evolve(one, problem=str(n), n=n, counts=Counts(factorizations=1000 if n < 10 else n**3)) for n in sizes
    )
    results = evolve(made(), rows=rows)
    assert chart.exponents(results, "factorizations")["p", "a"] == pytest.approx(3.0)
    assert chart.scaling(results, "factorizations").rows[0][-1] == 3.0
    assert math.isnan(chart.exponents(evolve(results, rows=rows[:2]), "factorizations")["p", "a"])


def test_tables_as_text_and_markdown():
    table = chart.Table(("name", "n"), [("a|b", 1), ("c", math.nan)])
    assert table.text() == "name    n\n----  ---\na/b     1\nc"
    assert table.markdown() == "| name |   n |\n| ---- | --: |\n| a/b  |   1 |\n| c    |     |"


def test_errors_that_agree_to_three_digits_are_equal():
    results = made(("cheap", 1.0004e-3, 10, ""), ("dear", 1.0e-3, 20, ""), ("better", 0.9e-3, 30, ""))
    assert chart.excess(results, "e", "factorizations").tolist() == [1.0, 2.0, 1.0]
    assert [line[4] for line in chart.runs(results).rows] == ["*", "", "*"]
