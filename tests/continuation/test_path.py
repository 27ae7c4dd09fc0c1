"""What a path offers: parts, both directions, tables, files, pages for notebooks; and points at a parameter value."""

import numpy as np
import pytest

from continuation import (
    DEFAULT,
    FAST,
    Budget,
    Path,
    Status,
    from_functions,
    metric,
    solve_at,
    trace,
    trace_both,
)
from continuation import arclength as length
from continuation.archive import open_archive
from problems import lcp
from problems.bifurcation import Bratu1D, Circle, Cusp, FreudensteinRoth

from ..util import by_preset, every_preset, path_of

HIGH = 4.0 * np.sin(np.pi * np.arange(1, 21) / 21.0)


@pytest.fixture(scope="module")
def both():
    return trace_both(FreudensteinRoth(), target=None, box={"lam": (-3.0, 3.0)})


@pytest.fixture(scope="module")
def ahead():
    return trace(FreudensteinRoth())


def steps(path):
    return [event.step for event in path.events]


@by_preset(FAST, DEFAULT)
@pytest.mark.parametrize("homotopy", [Circle(), Cusp(), FreudensteinRoth()], ids=lambda h: type(h).__name__)
def test_accumulated_arclength_is_the_length_to_the_fourth_order_in_the_angle(homotopy, preset):
    path = trace(homotopy, preset=preset, metric=metric.Euclidean())
    whole, angle = length(homotopy, path), max(step.angle for step in path.steps)
    # 5e-3 of the fourth power at most; of a circle the parts are exact, and quadrature is good to 1e-9.
    assert abs(path.arclength[-1] - whole) <= (1e-2 * angle**4 * (not isinstance(homotopy, Circle)) + 2e-9) * whole


def test_both_directions_are_one_path(both):
    assert (both.lam[0], both.lam[-1]) == (-3.0, 3.0)
    assert (np.diff(both.arclength) > 0.0).all()
    assert [event.name for event in both.events] == ["lam = -3", "turning point", "turning point", "lam = 3"]
    for event in both.events:
        np.testing.assert_allclose(both(event.arclength), event.u, rtol=1e-3, atol=1e-3)
    assert both.status is Status.STOPPED_AT_EVENT
    assert "The other way: " in both.message
    assert len({step.orientation for step in both.steps}) == 1


def test_turned_round_twice_it_is_the_same(ahead):
    back = ahead.reversed()
    s = np.linspace(0.0, ahead.arclength[-1], 40)
    np.testing.assert_allclose(back(s), ahead(ahead.arclength[-1] - s), atol=1e-12)
    np.testing.assert_array_equal(back.reversed().u, ahead.u)
    assert steps(back.reversed()) == steps(ahead)
    assert steps(back) == [len(ahead) - step for step in reversed(steps(ahead))]


def test_parts_keep_arclength_and_events_and_join_to_the_whole(ahead):
    part = ahead[10:15]
    assert part.arclength[0] == ahead.steps[10].arclength
    np.testing.assert_allclose(part(part.arclength[-1]), ahead.steps[14].u, rtol=1e-14)
    assert len(ahead[::3]) == len(range(0, len(ahead), 3))
    assert ahead[-1] is ahead.endpoint
    whole = ahead[:9].join(ahead[8:].reversed().reversed())
    np.testing.assert_allclose(whole.u, ahead.u)
    np.testing.assert_allclose(whole.arclength, ahead.arclength)
    assert steps(whole) == steps(ahead) == steps(ahead[:])


def test_tables(ahead):
    pytest.importorskip("xarray")
    pytest.importorskip("pandas")
    data, frame = ahead.to_xarray(), ahead.to_dataframe()
    rows = len(ahead) + sum(not event.ends_step for event in ahead.events)
    assert len(frame) == data.sizes["point"] == rows
    assert set(frame["event"]) == {"", "turning point"}
    np.testing.assert_array_equal(frame["y_0"][frame["role"] == 0], ahead.y[:, 0])
    assert "lambda" in trace(Bratu1D(3)).to_dataframe().columns


def test_one_line_and_one_page_each(ahead, tmp_path):
    solution = lcp.solve(lcp.LCP([[2.0]], [-1.0]))
    assert (bool(solution), bool(lcp.solve(lcp.LCP([[-1.0]], [-1.0])))) == (True, False)
    for thing in (ahead, ahead[3], ahead.events[0], solution):
        assert "\n" not in repr(thing)
        assert len(repr(thing)) < 120
    ahead.save(tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        pages = [thing._repr_html_() for thing in (ahead, solution, archive)]
    assert all(page.startswith("<table>") and page.count("<tr>") == page.count("</tr>") > 1 for page in pages)


def test_refined_until_it_is_as_accurate_as_asked():
    homotopy, worst = Bratu1D(20), []
    path = trace(homotopy)
    for accuracy in (1e-2, 1e-6, 1e-8):
        fine = path.refined(homotopy, accuracy)
        points = fine(np.linspace(0.0, fine.arclength[-1], 200))
        worst.append(max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in points))
        for event in fine.events:
            assert fine.steps[event.step - 1].arclength <= event.arclength <= fine.steps[event.step].arclength
    assert worst[0] > 10.0 * worst[1] > 100.0 * worst[2]
    assert len(fine) > len(path)


# No point solves it, and chord steps from the circle do not halve.
EMPTY = from_functions(lambda y, lam: y**2 + lam**2 + 3.0, Circle().jacobian, start=Circle().start())


@every_preset
def test_dense_output_is_no_farther_off_than_its_bound(preset):
    path = trace(Circle(), target=-0.9999, preset=preset)
    s = np.linspace(0.0, path.arclength[-1], 41)
    bound, found = path.error_bound(Circle(), s), path(s)
    off = np.abs(np.hypot(*found.T) - 1.0)
    size = np.hypot(*bound.T)
    assert (off <= size).all()
    assert (size <= 2.5 * off + 1e-12).all()
    np.testing.assert_array_equal(path.error_bound(Circle(), s[3]), bound[3])
    assert not np.isfinite(path.error_bound(EMPTY, s[3])).any()


def test_a_point_at_a_parameter_value():
    homotopy = Bratu1D(20)
    low, high = solve_at(homotopy, 1.0), solve_at(homotopy, 1.0, HIGH)
    assert max(np.abs(homotopy.residual(y, 1.0)).max() for y in (low, high)) < 1e-12
    assert high.max() > low.max() + 2.0
    path = trace(homotopy, start=(HIGH, 1.0), direction=1, target=2.0)
    assert path.steps[0].lam == 1.0
    assert path.endpoint.y.max() > 2.0


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda path: solve_at(Bratu1D(20), 9.0), "lam = 9"),
        (lambda path: solve_at(Bratu1D(20), 1.0, [1.0, 2.0]), "guess: expected 20 numbers, found 2"),
        (lambda path: trace(Bratu1D(20), start=([1.0, 2.0], 1.0)), "start: expected 20 unknowns, found 2"),
        (lambda path: trace_both(FreudensteinRoth(), direction=1), "direction: expected none"),
        (lambda path: Path(path[8:].steps).join(path[:9]), "other: expected a path that begins at"),
        (lambda path: path[::-1], "reversed"),
        (lambda path: path.refined(FreudensteinRoth(), 0.0), "accuracy: expected a positive number"),
    ],
)
def test_what_cannot_be_is_named(ahead, call, words):
    with pytest.raises((ValueError, ArithmeticError), match=words):
        call(ahead)


def test_a_start_that_newton_brings_to_the_path_is_a_start():
    """Newton's increments grow at first: x - arctan's inverse is far from linear."""
    path = path_of(from_functions(lambda y, lam: np.arctan(y) - 0.1 + lam, start=([1.38], 0.0), target=0.05))
    assert path.endpoint.y[0] == pytest.approx(np.tan(0.05), abs=1e-9)


@pytest.mark.parametrize(
    ("box", "value", "end", "name"),
    [
        ({"lam": (None, 2.0)}, lambda u: u[-1], 2.0, "lam = 2"),
        ({0: (None, 0.5)}, lambda u: u[0], 0.5, "component 0 = 0.5"),
        ({"lambda": (-1, 2.0)}, lambda u: u[-1], 2.0, "lam = 2"),
        ({"y": (-1.0, 1.5)}, lambda u: u[:-1].max(), 1.5, "largest unknown = 1.5"),
        ({"y": (-1.0, 100.0), "lam": (-2.0, 3.0)}, lambda u: u[-1], 3.0, "lam = 3"),
    ],
)
def test_a_path_ends_on_the_face_of_its_box(box, value, end, name):
    path = trace(Bratu1D(5), box=box)
    assert (path.status, path.events[-1].name) == (Status.STOPPED_AT_EVENT, name)
    assert value(path.endpoint.u) == pytest.approx(end, abs=1e-8)


def test_a_budget_of_arclength():
    path = path_of(FreudensteinRoth(), max_step=0.2, budget=Budget(arclength=2.0), status=Status.BUDGET_EXHAUSTED)
    assert 2.0 <= path.arclength[-1] < 2.25
    assert path.message.endswith("Reached: 2 of arclength.")
