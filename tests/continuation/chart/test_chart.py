"""Work-precision studies on paths in closed form: what is counted, what counts as a failure, what is kept and drawn."""

import math

import matplotlib as mpl
import numpy as np
import pytest
from attrs import evolve

import continuation
from continuation import chart
from continuation.archive.errors import ArchiveError, ArchiveExistsError
from continuation.chart.report import report
from continuation.counts import Counts
from continuation.predictors import Hermite
from problems.bifurcation import Circle, ExponentialCosine
from problems.bifurcation.truth import circle, exponential_cosine
from problems.charts.subjects import cosine

mpl.use("Agg")


def row(results, method, rung=1e-8):
    return next(r for r in results.of(method=method) if r.rung == rung or math.isnan(r.rung))


def test_every_method_has_its_rows(results):
    assert [(r.method, r.rung) for r in results.of(method="Hermite")] == [("Hermite", 1e-4), ("Hermite", 1e-8)]
    assert len(results.of(method="raises")) == 1
    assert len(results.rows) == 8


@pytest.mark.parametrize(
    ("method", "failure"),
    [("Hermite", ""), ("jumps", "jump"), ("broke", "budget"), ("raises", "exception"), ("lies", "wrong end")],
)
def test_what_went_wrong_is_named(results, method, failure):
    assert row(results, method).failure == failure


def test_the_reason_is_kept(results):
    assert row(results, "raises").message == "ArithmeticError: on purpose"
    assert "the path has 10" in row(results, "jumps").message


def test_counts_are_those_of_a_single_trace(results):
    path = continuation.trace(ExponentialCosine(5), predictor=Hermite(), tolerance=1e-4)
    found = row(results, "Hermite", 1e-4)
    assert found.counts == path.counts
    assert found.turns == len(path.turning_points)
    table = chart.runs(results)
    line = dict(zip(table.head, table.rows[0]))
    assert line["factorizations"] == path.counts.factorizations
    assert line["solves"] == path.counts.solves
    assert line["residuals"] == path.counts.residuals


def test_errors_are_those_of_the_path(results):
    n = 5
    path = continuation.trace(ExponentialCosine(n), predictor=Hermite(), tolerance=1e-8)
    end = exponential_cosine.curve(n, np.array(exponential_cosine.end(n)))
    found = row(results, "Hermite").errors
    assert found["end_point"] == np.abs(path.endpoint.u - end).max() / (1.0 + np.abs(end).max())
    # Between the points the dense output is a cubic, so it is far worse than the corrected end; but it stays near.
    assert found["end_point"] < found["curve_distance"] < 1e-2
    assert found["turning_points"] < 1e-10
    assert found["arclength"] < 1e-6
    assert math.isnan(row(results, "jumps").errors["turning_points"])
    assert math.isnan(row(results, "lies").errors["arclength"])


def test_the_distance_without_a_closed_form_is_that_to_the_nearest_point():
    # Two points on the unit circle joined by a straight line of dense output: the middle is 1 - cos(pi/8) inside.
    angle = np.array([0.0, math.pi / 4])
    u = circle.curve(angle)
    steps = [continuation.Step(k, point, np.zeros(2), float(angle[k])) for k, point in enumerate(u)]
    answer = chart.Answer(Counts(), continuation.Path(steps), u[-1])
    problem = chart.Problem("circle", Circle())
    middle = (u[0] + u[1]) / 2
    foot = middle / np.linalg.norm(middle)
    expected = np.abs(middle - foot).max() / (1.0 + foot.max())
    assert chart.CURVE_DISTANCE.measure(problem, answer) == pytest.approx(expected, rel=1e-9)


def test_shorter_steps_make_better_dense_output():
    study = chart.Study(
        name="steps",
        problems=[cosine(3)],
        methods=[chart.traced("Hermite")],
        ladder=chart.longest_steps(0.3, 0.01),
        errors=[chart.CURVE_DISTANCE],
        repeats=0,
    )
    long, short = chart.run(study).rows
    assert short.errors["curve_distance"] < 0.1 * long.errors["curve_distance"]
    assert short.counts.accepted > 3 * long.counts.accepted


def test_a_reference_knows_what_the_closed_form_knows():
    truth = chart.reference(ExponentialCosine(3))
    exact = cosine(3).truth
    np.testing.assert_allclose(truth.end, exact.end, rtol=0, atol=1e-13)
    np.testing.assert_allclose(truth.turning_points, exact.turning_points, rtol=0, atol=1e-11)
    with pytest.raises(ArithmeticError, match="did not arrive"):
        chart.reference(ExponentialCosine(3), budget=continuation.Budget(steps=2))


def test_what_was_out_of_budget_is_not_run_on_larger_problems():
    ran = []

    def spend(problem, rung):
        ran.append((problem.name, rung.value))
        return chart.Answer(Counts(factorizations=9), failure=chart.Failure.BUDGET if problem.n > 1 else "")

    sizes = {"small": 1, "middle": 2, "large": 3, "other": 3}
    study = chart.Study(
        name="spent",
        problems=[chart.Problem(k, None, n=n, family="other" if k == "other" else "one") for k, n in sizes.items()],
        methods=[chart.Method("spends", spend)],
        ladder=chart.tolerances(1e-2, 1e-4),
        errors=[chart.END_POINT],
        repeats=0,
        give_up=True,
    )
    rows = chart.run(study).rows
    assert ran == [("small", 1e-2), ("small", 1e-4), ("middle", 1e-2), ("other", 1e-2)]
    assert [row.failure for row in rows] == ["", "", *["budget"] * 6]
    assert rows[4].message == "Not run: it was out of budget on middle."
    assert [row.spared for row in rows] == [False] * 3 + [True] * 3 + [False, True]
    del ran[:]
    chart.run(evolve(study, give_up=False))
    assert len(ran) == len(rows)


def same(a, b):
    """Equality of rows, NaN equal to NaN."""
    return repr(a) == repr(b)


def test_results_come_back_from_their_file(results, tmp_path):
    file = chart.write(results, tmp_path / "closed.h5")
    again = chart.read(file)
    assert same(again.rows, results.rows)
    assert (again.study, again.title, again.ladder, again.errors, again.work) == (
        results.study, results.title, results.ladder, results.errors, results.work
    )  # fmt: skip
    assert again.provenance["threads"] == results.provenance["threads"]
    assert chart.runs(again).text() == chart.runs(results).text()
    with pytest.raises(ArchiveExistsError):
        chart.write(results, file)


def test_the_file_is_one_for_xarray(results, tmp_path):
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(chart.write(results, tmp_path / "x.h5"), engine="h5netcdf") as data:
        assert data.sizes == {"run": len(results.rows)}
        assert data.seconds.attrs["units"] == "s"
        assert data.factorizations.values.tolist() == [r.counts.factorizations for r in results.rows]


def test_a_file_of_another_kind_is_refused(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file.attrs["schema"] = "continuation-chart-2"
    with pytest.raises(ArchiveError, match="continuation-chart-1"):
        chart.read(tmp_path / "other.h5")
    with pytest.raises(ArchiveError, match="cannot be opened"):
        chart.read(tmp_path / "none.h5")


def test_the_chart_shows_lines_front_and_failures(results):
    # Turning points are round-off at either tolerance: a panel of that has no front.
    figure = chart.draw(results, "curve_distance", "factorizations")
    figure.canvas.draw()
    (panel,) = figure.axes
    (strip,) = panel.child_axes
    assert panel.get_xscale() == panel.get_yscale() == "log"
    line = panel.get_lines()[0]
    assert line.get_ydata().tolist() == [r.counts.factorizations for r in results.of(method="Hermite")]
    rings = panel.get_lines()[-1]
    front = chart.on_front(results.rows, "curve_distance", "factorizations")
    assert rings.get_ydata().tolist() == [r.counts.factorizations for r in front]
    marks = [float(mark.get_xdata()[0]) for mark in strip.get_lines()]
    failed = [results.methods.index(r.method) for r in results.rows if r.failed]
    assert marks == failed
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()][: len(results.methods)] == results.methods


def test_lines_differ_by_more_than_colour():
    from continuation.chart.style import line_style

    looks = [line_style(k) for k in range(20)]
    assert len({(a["marker"], a["linestyle"]) for a in looks}) == len(looks)


@pytest.mark.parametrize("bad", [{"error": "none"}, {"work": "none"}])
def test_an_unknown_axis_is_named(results, bad):
    with pytest.raises(ValueError, match=f"{next(iter(bad))}: expected one of"):
        chart.draw(results, **{"error": "end_point", "work": "seconds", **bad})


@pytest.mark.parametrize("kind", ["problems", "methods"])
def test_what_is_not_there_is_not_drawn(results, kind):
    with pytest.raises(ValueError, match=f"{kind}: expected some of"):
        chart.draw(results, "end_point", "seconds", **{kind: ["none"]})


def test_without_matplotlib_there_are_no_figures(study, results, tmp_path, monkeypatch):
    def missing(*_, **__):
        raise ImportError("none here")

    monkeypatch.setattr("continuation.chart.style.require_matplotlib", missing)
    assert [file.suffix for file in report(study, results, tmp_path)] == [".h5", ".csv", ".md"]
