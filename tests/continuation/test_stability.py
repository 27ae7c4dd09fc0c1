"""Stability along a path: how many eigenvalues are unstable, Hopf points, and what a count shows."""

import numpy as np
import pytest

from continuation import Budget, HopfPoint, Kind, Stability, Status, TargetValue, from_functions, trace
from continuation.archive import open_archive, resume
from continuation.controllers import Bounds, Fixed
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.linear import factor_bordered
from continuation.metric import Euclidean

from ..util import every_preset
from .curves.util import Diffusing
from .diagrams.util import Forks


def hopf_points(path):
    return [event for event in path.events if event.kind == Kind.HOPF]


def unstable(path):
    return [step.observed["unstable"] for step in path.steps]


def events(path):
    return [(event.kind, event.lam, event.observed) for event in path.events]


def brusselator(A):
    def rates(y, B):
        made = y[0] * y[0] * y[1]
        return np.stack([A - (B + 1.0) * y[0] + made, B * y[0] - made])

    return from_functions(rates, start=([A, 0.5 / A], 0.5), target=3.0 + A * A)


def catalyst(u, q2):
    z = 1.0 - u[0] - u[1] - u[2]
    oxidised = 10.0 * u[0] * u[1]
    first, second = 5.0 * z * z - 2.0 * u[0] ** 2 - oxidised, q2 * z - 0.1 * u[1] - oxidised
    return np.stack([first, second, 0.0675 * (z - 0.4 * u[2])])


@every_preset
@pytest.mark.parametrize("A", [0.5, 1.0, 2.0])
def test_the_brusselator_oscillates_from_one_plus_a_squared_on(preset, A):
    path = trace(brusselator(A), observers=[Stability()], preset=preset)
    (event,) = hopf_points(path)
    assert (event.lam, event.observed["frequency"]) == pytest.approx((1.0 + A * A, A), abs=1e-10)
    assert unstable(path) == [2.0 * (lam > 1.0 + A * A) for lam in path.lam]


@pytest.mark.parametrize(("options", "count"), [({"terminal": 1}, 1), ({"direction": -1}, 0), ({"direction": 1}, 1)])
def test_a_hopf_point_may_end_the_path_and_only_one_way_of_crossing_may_count(options, count):
    path = trace(brusselator(1.0), events=[HopfPoint(**options)])
    assert len(hopf_points(path)) == count
    assert (path.endpoint.kind == Kind.HOPF) == ("terminal" in options) == (path.status is Status.STOPPED_AT_EVENT)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("k", [None, 8])
def test_several_pairs_that_cross_within_one_step_are_all_found(k, side):
    homotopy = Diffusing(side=side)
    path = trace(homotopy, observers=[Stability(k=k, side=side)])
    found = [(event.lam, event.observed["frequency"]) for event in hopf_points(path)]
    assert len(found) == 3
    for mode, event in enumerate(found, start=1):
        assert event == pytest.approx((homotopy.rate(mode), 3.0), abs=1e-10)
    assert len(path) < 8
    assert unstable(path)[-1] == 6.0
    assert all(step.observed["covered"] for step in path.steps)


@pytest.mark.parametrize(("target", "found"), [(0.15, 0), (0.25, 1)])
def test_what_stability_and_a_hopf_point_cost_on_a_large_sparse_branch(target, found):
    homotopy = Diffusing(1000, target)
    alone, watched = trace(homotopy), trace(homotopy, observers=[Stability()])
    assert [event.lam for event in hopf_points(watched)] == pytest.approx(found * [homotopy.rate(1)], abs=1e-10)
    np.testing.assert_array_equal(watched.u, alone.u)
    # One factorisation a point, none to find out that nothing crosses, and no H_y beyond those of the steps: it is kept
    # there, so that an arc which is looked at again needs it once. A secant needs two spectra: one on the way, and that
    # of the point.
    assert watched.counts.factorizations == alone.counts.factorizations + len(alone) + 2 * found
    more = watched.counts.jacobians - alone.counts.jacobians
    assert more <= 3 * found
    assert watched.counts.solves <= alone.counts.solves + 40 * (len(alone) + found)
    assert all(step.observed["covered"] for step in watched.steps)


@every_preset
def test_a_pair_that_crosses_and_becomes_real_before_a_turning_point_is_seen(preset):
    # MatCont's catalytic oscillator: long steps have a Hopf point, the split of its pair and a turning point in one.
    homotopy = from_functions(catalyst, start=([0.001137, 0.891483, 0.062345], 2.204678), target=None)
    options = {"box": {"lam": (0.95, 2.5), 0: (None, 0.12)}, "direction": -1, "preset": preset}
    path = trace(homotopy, observers=[Stability()], **options)
    places = [event.lam for event in path.events if event.kind in (Kind.HOPF, Kind.TURNING_POINT)]
    np.testing.assert_allclose(places, [1.051558, 1.042049, 1.052200, 1.040991], atol=1e-6)
    assert len(hopf_points(path)) == 2
    for event in hopf_points(path):
        values = np.linalg.eigvals(Evaluator(homotopy, Counts()).derivative(event.y, event.lam)[0])
        assert np.abs(values.real).min() < 1e-10


# -- what a count shows ---------------------------------------------------------------------------------------


class Unseen(Forks):
    """Pitchforks on a trunk with factors of their own, so that no product with H' shows what crosses."""

    target = 1.5

    def bordered(self, y, lam, border):
        return factor_bordered(*self.jacobian(y, lam), border)


def test_a_pair_of_branch_points_within_a_step_is_told_apart_by_the_count():
    homotopy = Unseen((1.0, 1.003, 2.5))
    assert trace(homotopy).events == []
    # The sign of the determinant alone tells one from none.
    assert [event.lam for event in trace(Unseen((1.0, 2.5))).events] == pytest.approx([1.0], abs=1e-10)
    path = trace(homotopy, observers=[Stability()])
    np.testing.assert_allclose([event.lam for event in path.events], [1.0, 1.003], rtol=0, atol=1e-10)
    assert any("change sides" in str(failed) for step in path.steps for failed in step.rejected)


def test_what_lies_before_a_terminal_event_is_accounted_for():
    options = {"controller": Fixed(Bounds(initial=1.0)), "metric": Euclidean(), "target": 3.0}
    path = trace(Forks((1.0,)), observers=[Stability()], events=[TargetValue(1.2)], **options)
    assert [event.name for event in path.events] == ["branch point", "lam = 1.2"]
    assert [step.rejections for step in path.steps] == [0, 0]


def test_what_never_can_be_told_apart_does_not_stop_the_path():
    path = trace(Unseen((1.0, 1.0, 2.5)), observers=[Stability()])
    assert (path.status, unstable(path)[-1]) == (Status.REACHED_TARGET, 2.0)


# -- stored, resumed, drawn -----------------------------------------------------------------------------------


def test_counts_and_frequencies_are_kept_in_archives_and_resuming_goes_on_with_them(tmp_path):
    homotopy = Diffusing()
    options = {"observers": [Stability()], "max_step": 0.1}
    whole = trace(homotopy, archive=tmp_path / "whole.h5", **options)
    trace(homotopy, archive=tmp_path / "part.h5", budget=Budget(steps=3), **options)
    resumed = resume(tmp_path / "part.h5", homotopy, budget=Budget())
    assert [event.kind for event in whole.events] == 3 * [Kind.HOPF]
    with open_archive(tmp_path / "whole.h5") as archive:
        for other in (archive.path(0), resumed):
            assert [step.observed for step in other.steps] == [step.observed for step in whole.steps]
            assert events(other) == events(whole)


def drawn(axes):
    return [(line.get_linestyle(), line.get_xdata()) for line in axes.lines if line.get_linestyle() in ("-", "--")]


@pytest.mark.parametrize("options", [{"components": [1]}, {"value": 1}])
def test_a_path_is_drawn_solid_up_to_the_event_at_which_it_becomes_unstable(options):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    axes = trace(brusselator(1.0), observers=[Stability()]).plot(**options)
    (solid, before), (dashed, behind) = drawn(axes)
    assert (solid, dashed) == ("-", "--")
    assert before[-1] == behind[0] == pytest.approx(2.0, abs=1e-2)
    assert "*" in {line.get_marker() for line in axes.lines}
    assert [style for style, _ in drawn(trace(brusselator(1.0)).plot(**options))] == ["-"]
    pyplot.close("all")


def test_a_scalar_of_the_homotopy_with_the_same_name_is_refused():
    counting = type("Counting", (Diffusing,), {"observe": lambda self, y, lam: {"unstable": 1.0}})()
    with pytest.raises(ValueError, match="observe: expected each name once, found 'unstable' of an event too"):
        trace(counting, observers=[Stability()])
