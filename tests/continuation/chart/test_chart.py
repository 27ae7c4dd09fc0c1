"""Studies on paths in closed form: what is counted, what counts as a failure, what is kept and drawn."""

from unittest.mock import Mock

import matplotlib as mpl
import numpy as np
import pytest

import continuation
from continuation import chart
from continuation.chart.run import report
from problems.bifurcation import ExponentialCosine
from problems.charts.subjects import cosine
from tests.truth import exponential_cosine

mpl.use("Agg")


def row(results, method, rung=1e-8):
    return next(r for r in results.of(method=method) if r.rung == rung)


def test_what_went_wrong_is_named_with_its_reason(results):
    failures = {r.method: r.failure for r in results.rows if not r.rung > 1e-8}
    assert failures == {"Hermite": "", "jumps": "jump", "broke": "budget", "raises": "exception", "lies": "wrong end"}
    assert (len(results.rows), [r.rung for r in results.of(method="Hermite")]) == (10, [1e-4, 1e-8])
    assert row(results, "raises").message == "ZeroDivisionError: integer division or modulo by zero"
    assert "the path has 10" in row(results, "jumps").message


def test_a_reference_knows_what_the_closed_form_knows():
    for n in (3, 5, 8):
        truth, end = cosine(n).truth, exponential_cosine.curve(n, np.array(exponential_cosine.end(n)))
        np.testing.assert_allclose(truth.end, end, rtol=0, atol=1e-13)
        assert truth.turns == len(exponential_cosine.turning_points(n))
    with pytest.raises(ArithmeticError, match="did not arrive"):
        chart.reference(ExponentialCosine(3), budget=continuation.Budget(steps=2))


def test_results_come_back_from_their_file_to_the_last_bit(results, tmp_path):
    file = chart.write(results, tmp_path / "closed.json")
    again = chart.read(file)
    # NaN is not equal to itself; its text is.
    assert repr(again.rows) == repr(list(results.rows))
    assert (again.study, again.title, again.ladder, again.errors) == (
        results.study, results.title, results.ladder, results.errors
    )  # fmt: skip
    assert again.provenance == results.provenance
    assert chart.summary(again).text() == chart.summary(results).text()
    for other in ("a,b\n1,2\n", "[]", '{"rows": [{}]}'):
        (tmp_path / "other.json").write_text(other)
        with pytest.raises(ValueError, match="file: expected results that `write` wrote"):
            chart.read(tmp_path / "other.json")


def test_lines_are_named_in_the_order_of_their_ends(results):
    figure = chart.Lines("end_point", ("factorizations", "seconds")).draw(results)
    panel, timed = figure.axes
    assert panel.get_xscale() == panel.get_yscale() == "log"
    assert panel.xaxis_inverted()
    work = [(r.counts.factorizations, r.seconds) for r in results.of(method="Hermite")]
    assert [*zip(*(axes.get_lines()[0].get_ydata().tolist() for axes in (panel, timed)), strict=True)] == work
    key = [text.get_text() for text in panel.get_legend().get_texts()]
    ends = {line.get_label(): [*line.get_ydata(), 0.0][-2:][0] for line in panel.get_lines()}
    assert ("Hermite" in key, key) == (True, sorted(key, key=lambda name: -ends[name]))
    # What has no point on the panel is named in the end.
    assert [name.partition(" ")[0] for name in key[-4:]] == ["jumps", "broke", "raises", "lies"]
    assert all("failed" in name for name in key[-4:])


@pytest.mark.parametrize(
    ("picture", "complaint"),
    [
        (chart.Lines("none", "seconds"), "error: expected some of"),
        (chart.Lines("end_point", "none"), "work: expected some of"),
        (chart.Lines("end_point", "seconds", ["none"]), "problems: expected some of"),
        (chart.Profile("none"), "work: expected some of"),
        (chart.Profile("seconds", "family"), "by: expected some of"),
    ],
)
def test_what_is_not_there_is_not_drawn(results, picture, complaint):
    with pytest.raises(ValueError, match=complaint):
        picture.draw(results)


def test_without_matplotlib_there_are_no_figures(study, results, tmp_path, monkeypatch):
    missing = Mock(side_effect=ImportError("none here"))
    monkeypatch.setattr("continuation.chart.panels.require_matplotlib", missing)
    assert [file.suffix for file in report(study, results, tmp_path)] == [".json"]
