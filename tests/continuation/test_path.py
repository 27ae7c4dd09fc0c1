"""What a path offers: parts, both directions, tables, files, pages for notebooks; and points at a parameter value."""

import numpy as np
import pytest

import continuation
from continuation import Status
from continuation.archive import open_archive
from continuation.arguments import plugins
from problems import lcp
from problems.bifurcation import Bratu1D, Circle, Cusp, FreudensteinRoth

from ..util import every_preset

BOX = {"lam": (-3.0, 3.0)}
HIGH = 4.0 * np.sin(np.pi * np.arange(1, 21) / 21.0)


@pytest.fixture(scope="module")
def both():
    return continuation.trace_both(FreudensteinRoth(), target=None, box=BOX)


@pytest.fixture(scope="module")
def ahead():
    return continuation.trace(FreudensteinRoth())


def residuals(homotopy, path, count=200):
    s = np.linspace(path.arclength[0], path.arclength[-1], count)
    return max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in path(s))


@pytest.mark.parametrize("preset", [continuation.FAST, continuation.DEFAULT, continuation.CONSERVATIVE])
@pytest.mark.parametrize("homotopy", [Circle(), Cusp(), FreudensteinRoth()], ids=lambda h: type(h).__name__)
def test_accumulated_arclength_is_the_length_to_the_fourth_order_in_the_angle(homotopy, preset):
    path = continuation.trace(homotopy, preset=preset, metric=continuation.metric.Euclidean())
    length, angle = continuation.arclength(homotopy, path), max(step.angle for step in path.steps)
    # 5e-3 of the fourth power at most; of a circle the parts are exact, and quadrature is good to 1e-9.
    assert abs(path.arclength[-1] - length) <= (1e-2 * angle**4 * (not isinstance(homotopy, Circle)) + 2e-9) * length


def test_both_directions_are_one_path(both):
    assert (both.lam[0], both.lam[-1]) == (-3.0, 3.0)
    assert (np.diff(both.arclength) > 0.0).all()
    assert [event.name for event in both.events] == ["lam = -3", "turning point", "turning point", "lam = 3"]
    for event in both.events:
        np.testing.assert_allclose(both(event.arclength), event.u, rtol=1e-3, atol=1e-3)
    assert both.status is Status.STOPPED_AT_EVENT
    assert "The other way: " in both.message
    assert len({step.orientation for step in both.steps}) == 1


def test_both_directions_of_a_direction_are_refused():
    with pytest.raises(ValueError, match="direction: expected none"):
        continuation.trace_both(FreudensteinRoth(), direction=1)


def test_turned_round_twice_it_is_the_same(ahead):
    back = ahead.reversed()
    s = np.linspace(0.0, ahead.arclength[-1], 40)
    np.testing.assert_allclose(back(s), ahead(ahead.arclength[-1] - s), atol=1e-12)
    again = back.reversed()
    np.testing.assert_array_equal(again.u, ahead.u)
    assert [event.step for event in again.events] == [event.step for event in ahead.events]
    assert [event.step for event in back.events] == [len(ahead) - event.step for event in reversed(ahead.events)]


def test_parts_join_to_the_whole(ahead):
    first, second = ahead[:9], ahead[8:]
    second = continuation.Path(second.steps, second.events)
    assert len(first) + len(second) == len(ahead) + 1
    with pytest.raises(ValueError, match="other: expected a path that begins at"):
        second.join(first)
    shifted = ahead[8:].reversed().reversed()
    np.testing.assert_allclose(first.join(shifted).u, ahead.u)
    np.testing.assert_allclose(first.join(shifted).arclength, ahead.arclength)
    assert [event.step for event in first.join(shifted).events] == [event.step for event in ahead.events]


def test_slices_keep_arclength_and_events(ahead):
    part = ahead[10:15]
    assert part.arclength[0] == ahead.steps[10].arclength
    np.testing.assert_array_equal(part(part.arclength[-1]), ahead.steps[14].u)
    assert [event.name for event in ahead[:].events] == [event.name for event in ahead.events]
    assert len(ahead[::3]) == len(range(0, len(ahead), 3))
    assert ahead[-1] is ahead.endpoint
    with pytest.raises(ValueError, match="reversed"):
        ahead[::-1]


def test_a_saved_path_is_read_as_it_was(tmp_path, both):
    both.save(tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        again = archive.path(0)
    np.testing.assert_array_equal(again.u, both.u)
    np.testing.assert_array_equal(again.tangents, both.tangents)
    assert [event.step for event in again.events][1:] == [event.step for event in both.events][1:]
    assert (again.status, again.counts) == (both.status, both.counts)
    with pytest.raises(FileExistsError):
        both.save(tmp_path / "run.h5")


def test_tables(ahead):
    xarray, pandas = pytest.importorskip("xarray"), pytest.importorskip("pandas")
    data, frame = ahead.to_xarray(), ahead.to_dataframe()
    assert isinstance(data, xarray.Dataset)
    assert isinstance(frame, pandas.DataFrame)
    rows = len(ahead) + sum(not event.ends_step for event in ahead.events)
    assert len(frame) == data.sizes["point"] == rows
    assert set(frame["event"]) == {"", "turning point"}
    np.testing.assert_array_equal(frame["y_0"][frame["role"] == 0], ahead.y[:, 0])
    named = continuation.trace(Bratu1D(3)).to_dataframe()
    assert "lambda" in named.columns


def test_one_line_each(ahead, tmp_path):
    solution = lcp.solve(lcp.LCP([[2.0]], [-1.0]))
    for thing in (ahead, ahead[3], ahead.events[0], solution):
        assert "\n" not in repr(thing)
        assert len(repr(thing)) < 120
    ahead.save(tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        for thing in (ahead, solution, archive):
            page = thing._repr_html_()
            assert page.startswith("<table>")
            assert page.count("<tr>") == page.count("</tr>") > 1
    assert bool(solution)
    assert ahead.events[0].kind.name == "TURNING_POINT"
    assert ahead.to_dataframe() is not None


def test_a_solution_is_true_if_it_solves():
    assert not lcp.solve(lcp.LCP([[-1.0]], [-1.0]))


def test_refined_until_it_is_as_accurate_as_asked():
    homotopy = Bratu1D(60)
    path = continuation.trace(homotopy)
    found = [residuals(homotopy, path.refined(homotopy, accuracy)) for accuracy in (1e-2, 1e-6, 1e-8)]
    assert found[0] > 10.0 * found[1] > 100.0 * found[2]
    fine = path.refined(homotopy, 1e-4)
    assert len(fine) > len(path)
    for event in fine.events:
        assert fine.steps[event.step - 1].arclength <= event.arclength <= fine.steps[event.step].arclength
    with pytest.raises(ValueError, match="accuracy: expected a positive number"):
        path.refined(homotopy, 0.0)


class Empty(Circle):
    """No point solves it, and chord steps from the circle do not halve."""

    def residual(self, y, lam):
        return y**2 + lam**2 + 3.0


@every_preset
def test_dense_output_is_no_farther_off_than_its_bound(preset):
    path = continuation.trace(Circle(), target=-0.9999, preset=preset)
    s = np.linspace(0.0, path.arclength[-1], 41)
    bound, found = path.error_bound(Circle(), s), path(s)
    off = np.abs(np.hypot(*found.T) - 1.0)
    size = np.hypot(*bound.T)
    assert (off <= size).all()
    assert (size <= 2.5 * off + 1e-12).all()
    np.testing.assert_array_equal(path.error_bound(Circle(), s[3]), bound[3])
    assert not np.isfinite(path.error_bound(Empty(), s[3])).any()


def test_a_point_at_a_parameter_value():
    homotopy = Bratu1D(20)
    low, high = continuation.solve_at(homotopy, 1.0), continuation.solve_at(homotopy, 1.0, HIGH)
    for y in (low, high):
        assert np.abs(homotopy.residual(y, 1.0)).max() < 1e-12
    assert high.max() > low.max() + 2.0
    with pytest.raises(ArithmeticError, match="lam = 9"):
        continuation.solve_at(homotopy, 9.0)
    with pytest.raises(ValueError, match="guess: expected 20 numbers, found 2"):
        continuation.solve_at(homotopy, 1.0, [1.0, 2.0])


def test_a_start_that_newton_brings_to_the_path_is_a_start():
    """Newton's increments grow at first: x - arctan's inverse is far from linear."""

    def residual(y, lam):
        return np.arctan(y) - 0.1 + lam

    homotopy = continuation.from_functions(residual, start=([1.38], 0.0), target=0.05)
    path = continuation.trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.y[0] == pytest.approx(np.tan(0.05), abs=1e-9)


def test_a_start_of_ones_own(ahead):
    homotopy = Bratu1D(20)
    path = continuation.trace(homotopy, start=(HIGH, 1.0), direction=1, target=2.0)
    assert path.steps[0].lam == 1.0
    assert path.endpoint.y.max() > 2.0
    with pytest.raises(ValueError, match="start: expected 20 unknowns, found 3"):
        continuation.trace(homotopy, start=([1.0, 2.0, 3.0], 1.0))


@pytest.mark.parametrize(
    ("box", "end"),
    [({"lam": (None, 2.0)}, (-1, 2.0)), ({0: (None, 0.5)}, (0, 0.5)), ({"lambda": (-1, 2.0)}, (-1, 2.0))],
)
def test_a_path_ends_on_the_face_of_its_box(box, end):
    path = continuation.trace(Bratu1D(5), box=box)
    assert path.status is Status.STOPPED_AT_EVENT
    assert path.endpoint.u[end[0]] == pytest.approx(end[1], abs=1e-12)


def test_a_box_of_all_unknowns():
    path = continuation.trace(Bratu1D(5), box={"y": (-1.0, 1.5)})
    assert path.endpoint.y.max() == pytest.approx(1.5, abs=1e-8)
    assert path.events[-1].name == "largest unknown = 1.5"


def test_steps_are_no_longer_than_asked():
    path = continuation.trace(FreudensteinRoth(), max_step=0.1)
    assert max(step.step_length for step in path.steps) <= 0.1
    assert path.status is Status.REACHED_TARGET


def test_a_budget_of_arclength():
    path = continuation.trace(FreudensteinRoth(), max_step=0.2, budget=continuation.Budget(arclength=2.0))
    assert path.status is Status.BUDGET_EXHAUSTED
    assert 2.0 <= path.arclength[-1] < 2.25
    assert path.message.endswith("Reached: 2 of arclength.")


def test_an_exception_of_the_homotopys_own_is_no_edge_of_its_domain():
    def residual(y, lam):
        if lam > 0.5:
            raise ValueError("the table ends")
        return y - lam

    path = continuation.trace(continuation.from_functions(residual, start=([0.0], 0.0), target=1.0))
    assert path.status is Status.RAISED
    assert "ValueError: the table ends (test_path.py, line " in path.message
    assert path.lam[-1] == pytest.approx(0.5, abs=1e-8)


@pytest.mark.parametrize("name", ["bratu-1d", "bratu-2d", "aircraft", "cusp", "pitchfork", "circle"])
def test_every_plug_in_of_ours_ends_well_when_nothing_is_said(name):
    assert continuation.trace(plugins.make(name)).success
