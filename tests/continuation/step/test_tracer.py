"""The loop: every pair of parts, what a path is, iteration, observers and clocks."""

from itertools import product
from math import pi

import numpy as np
import pytest
from scipy.sparse import diags_array

from continuation import CONSERVATIVE, DEFAULT, FAST, Budget, Kind, Status, TargetValue, Tracer, from_functions, trace
from continuation.correctors import NaturalParameter
from continuation.metric import Euclidean
from continuation.rejection import Rejection
from problems.bifurcation import Circle, Cusp, FreudensteinRoth, Pitchfork

from ...util import every_preset
from .util import CONTROLLERS, CORRECTORS, METRICS, PREDICTORS, Watcher

# Every pair of parts occurs: the numbers of predictor, corrector and controller make a Latin square.
PAIRWISE = [
    (predictor, corrector, CONTROLLERS[(i + j) % len(CONTROLLERS)])
    for (i, predictor), (j, corrector) in product(enumerate(PREDICTORS), enumerate(CORRECTORS))
]


@pytest.mark.parametrize(("predictor", "corrector", "controller"), PAIRWISE, ids=repr)
def test_every_pair_of_parts_goes_round_the_circle(predictor, corrector, controller):
    path = trace(Circle(), predictor=predictor, corrector=corrector, controller=controller, metric=Euclidean())
    assert path.status is Status.CLOSED
    assert [round(event.lam, 9) for event in path.turning_points] == [1.0, -1.0]
    assert path.endpoint.arclength == pytest.approx(2.0 * pi, rel=1e-4)
    assert np.abs(np.hypot(path.y[:, 0], path.lam) - 1.0).max() <= 1e-7


@pytest.mark.parametrize(("predictor", "controller"), list(product(PREDICTORS, CONTROLLERS)), ids=repr)
def test_the_natural_parameter_follows_what_does_not_turn(predictor, controller):
    path = trace(Cusp(-0.7), predictor=predictor, corrector=NaturalParameter(), controller=controller)
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(path.endpoint.y, 1.0 + np.sqrt(0.7), rtol=1e-8)


@pytest.mark.parametrize("metric", METRICS, ids=repr)
@every_preset
def test_every_metric_follows_the_cusp(metric, preset):
    path = trace(Cusp(), metric=metric, preset=preset)
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(path.endpoint.u, (2.0, 6.0), rtol=1e-8)
    assert len(path.turning_points) == 2


def test_the_columns_of_a_path_agree():
    path = trace(FreudensteinRoth())
    m = len(path)
    assert path.y.shape == (m, 2)
    assert path.lam.shape == path.arclength.shape == (m,)
    assert path.tangents.shape == path.u.shape == (m, 3)
    assert path.steps[0].kind == Kind.START
    assert path.endpoint.kind == Kind.TARGET
    assert [step.index for step in path.steps] == list(range(m))
    assert all(step.residual_norm <= 1e-6 for step in path.steps)
    assert all(0.0 <= step.share <= 1.0 for step in path.steps)
    for before, after in zip(path.arclength, path.arclength[1:]):
        assert before < after


def test_tangents_are_of_unit_length_in_the_metric_and_in_the_kernel():
    path = trace(FreudensteinRoth(), metric=Euclidean())
    np.testing.assert_allclose(np.linalg.norm(path.tangents, axis=1), 1.0, rtol=1e-12)
    for step in path.steps:
        H_y, H_lam = FreudensteinRoth().jacobian(step.y, step.lam)
        image = H_y @ step.tangent[:-1] + H_lam * step.tangent[-1]
        assert np.abs(image).max() <= 1e-9 * np.abs(np.column_stack((H_y, H_lam))).max()


def test_the_orientation_never_changes_without_a_branch_point():
    path = trace(FreudensteinRoth())
    # The end is landed on at a fixed parameter; its determinant may be left unknown.
    assert {step.orientation for step in path.steps[:-1]} in ({1}, {-1})
    for step in path.steps[:-1]:
        H_y, H_lam = FreudensteinRoth().jacobian(step.y, step.lam)
        whole = np.vstack((np.column_stack((H_y, H_lam)), step.tangent))
        assert np.sign(np.linalg.det(whole)) == step.orientation


def test_dense_output_is_close_to_the_path():
    path = trace(Circle(), metric=Euclidean())
    s = np.linspace(0.0, path.endpoint.arclength, 200)
    np.testing.assert_allclose(np.hypot(*path(s).T), 1.0, rtol=0, atol=2e-4)
    np.testing.assert_allclose(path(s), np.column_stack((np.cos(s), np.sin(s))), rtol=0, atol=5e-3)
    np.testing.assert_array_equal(path(0.0), path.steps[0].u)
    with pytest.raises(ValueError, match="s: expected values in"):
        path(path.endpoint.arclength + 1.0)


def test_the_iterator_yields_every_step_and_the_last():
    tracer = Tracer(Cusp())
    steps = list(tracer)
    assert steps == tracer.path.steps
    assert steps[-1].kind == Kind.TARGET
    assert tracer.path.status is Status.REACHED_TARGET


def test_a_tracer_is_an_iterable_and_no_iterator():
    tracer = Tracer(Cusp())
    assert not hasattr(tracer, "__next__")
    assert iter(tracer) is not tracer


def test_an_iterator_left_early_leaves_a_consistent_path():
    tracer = Tracer(Cusp())
    for step in tracer:
        if step.index == 3:
            break
    del step
    assert len(tracer.path) == 4
    assert tracer.path.status is Status.ABANDONED


def test_a_loop_that_was_left_goes_on_and_hands_out_every_step_once():
    tracer, whole = Tracer(FreudensteinRoth()), trace(FreudensteinRoth())
    seen = []
    while not tracer.path.success:
        for step in tracer:
            seen.append(step.index)
            if step.index % 4 == 1:
                break
    assert seen == list(range(len(whole)))
    assert tracer.path.message == whole.message
    np.testing.assert_array_equal(tracer.path.u, whole.u)
    assert list(tracer) == []


def test_a_loop_that_was_left_before_the_first_step_begins_there():
    tracer = Tracer(Cusp())
    iter(tracer).close()
    assert [step.index for step in tracer] == list(range(len(trace(Cusp()))))


def test_two_loops_over_one_tracer_are_refused():
    tracer = Tracer(Cusp())
    steps = iter(tracer)
    next(steps)
    with pytest.raises(RuntimeError, match="iterated already"):
        next(iter(tracer))
    assert next(steps).index == 1


class Clock:
    def __init__(self, monkeypatch):
        self.now = 1e6
        monkeypatch.setattr("continuation.step.tracer.time.perf_counter", lambda: self.now)


def test_the_clock_runs_from_the_first_step_and_stands_still_between_loops(monkeypatch):
    clock = Clock(monkeypatch)
    tracer = Tracer(Cusp(), preset=CONSERVATIVE, budget=Budget(seconds=100.0))
    clock.now += 1000.0
    assert tracer.seconds == 0.0
    for step in tracer:
        clock.now += 10.0
        if step.index == 3:
            break
    assert tracer.seconds == tracer.path.seconds == 40.0
    clock.now += 1000.0
    for _ in tracer:
        clock.now += 10.0
    # One step each 10 seconds: the budget is reached before the eleventh.
    assert tracer.path.status is Status.BUDGET_EXHAUSTED
    assert len(tracer.path) == 10
    assert tracer.path.seconds == 100.0


def test_a_budget_in_seconds_of_a_resumed_path_counts_from_now_on(monkeypatch):
    clock, watcher = Clock(monkeypatch), Watcher()
    tracer = Tracer(Cusp(), budget=Budget(seconds=100.0), observers=(watcher,))
    for _ in tracer:
        clock.now += 40.0
    assert len(tracer.path) == 3
    rest = Tracer(Cusp(), budget=Budget(seconds=100.0), state=tracer.state)
    for _ in rest:
        clock.now += 40.0
    assert [step.index for step in rest.path.steps] == [3, 4, 5]


def test_observers_see_all_of_it_in_order():
    watcher = Watcher()
    path = trace(Cusp(), observers=(watcher,))
    assert [what for what in watcher.seen if what[0] == "step"] == [("step", k) for k in range(len(path))]
    assert watcher.seen[-1] == ("end", Status.REACHED_TARGET)
    assert sum(what[0] == "event" for what in watcher.seen) == len(path.events)
    # An event comes before the step that holds it.
    for event in path.events:
        assert watcher.seen.index(("event", event.name)) < watcher.seen.index(("step", event.step))


def test_accepted_and_rejected_are_counted():
    path = trace(FreudensteinRoth())
    assert path.counts.accepted == len(path) - 1
    assert path.counts.rejected == sum(step.rejections for step in path.steps) > 0
    for step in path.steps:
        assert len(step.rejected) == step.rejections
        # Attempts at one step, each shorter than the one before, and the one that was accepted shorter than all.
        tried = [*(attempt.h for attempt in step.rejected), step.step_length]
        assert tried == sorted(tried, reverse=True)
        assert {attempt.reason for attempt in step.rejected} <= {
            Rejection.CONTROLLER, Rejection.NOT_CONTRACTING, Rejection.NOT_CONVERGED, Rejection.MIDPOINT
        }  # fmt: skip
        assert all(attempt.contraction > 0.0 for attempt in step.rejected)


def test_one_unknown_given_as_a_number():
    path = trace(from_functions(lambda y, lam: y * y * y + y - lam, start=(0.0, 0.0), target=2.0))
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.u == pytest.approx([1.0, 2.0], abs=1e-10)


def test_five_thousand_sparse_unknowns():
    n = 5000
    laplacian = diags_array([np.ones(n - 1), np.full(n, -2.0), np.ones(n - 1)], offsets=[-1, 0, 1], format="csc")

    def residual(y, lam):
        return laplacian @ y + lam * np.exp(y) / (n + 1.0) ** 2

    def jacobian(y, lam):
        slope = np.exp(y) / (n + 1.0) ** 2
        return laplacian + diags_array([lam * slope], offsets=[0], format="csc"), slope

    homotopy = from_functions(residual, jacobian, start=(np.zeros(n), 0.0), target=None)
    path = trace(homotopy, events=[TargetValue(2.0, direction=-1)])
    assert path.status is Status.STOPPED_AT_EVENT
    (fold,) = path.turning_points
    # lam* - lam*_n = 1.8281 h^2 + O(h^4).
    assert fold.lam == pytest.approx(3.513830719125161 - 1.8281 / (n + 1) ** 2, abs=2e-11)


GOOD = from_functions(lambda y, lam: y - lam, start=([0.0], 0.0), target=1.0)


def test_the_homotopys_target_can_be_overridden():
    assert trace(GOOD, target=3.0).endpoint.lam == 3.0
    assert trace(GOOD, target=-3.0).endpoint.lam == -3.0
    assert trace(GOOD, target=None, budget=Budget(steps=4)).status is Status.BUDGET_EXHAUSTED


def test_an_unexamined_trace_follows_the_same_path_for_less():
    """Steps are those of a full trace up to the end; no turning point is located, and that is what is saved."""
    full, light = (trace(FreudensteinRoth(), examine=examine) for examine in (True, False))
    assert light.status is full.status
    assert light.events == []
    assert len(full.turning_points) > 0
    np.testing.assert_allclose(light.endpoint.u, full.endpoint.u, rtol=0, atol=1e-10)
    assert len(light) == len(full)
    assert light.counts.solves < full.counts.solves
    assert light.counts.residuals < full.counts.residuals


def test_an_unexamined_trace_does_not_cross_a_branch_point():
    path = trace(Pitchfork(), examine=False)
    assert path.status is Status.STEP_TOO_SMALL
    assert path.events == []


@pytest.mark.parametrize("preset", [FAST, DEFAULT])
def test_bends_as_wide_as_the_resolution_are_not_missed(preset):
    """An S without a shift, which no look sees that is not inside of it (docs/guarantee.md has the whole table)."""
    for seed in range(6):
        rng, w = np.random.default_rng([55, seed]), 0.02
        c, k, a = rng.uniform(2.0, 4.0), rng.uniform(2.0, 5.0), rng.uniform(0.2, 0.8)

        def along(y, w=w, c=c, k=k, a=a):
            x = (y - c) / w
            bump = np.exp(-(x**2))
            return y + a * np.sin(y) - w * k * x * bump, 1.0 + a * np.cos(y) - k * (1.0 - 2.0 * x * x) * bump

        path = trace(
            from_functions(
                lambda y, lam, f=along: f(y)[0] - lam,
                lambda y, lam, f=along: (np.diag(f(y)[1]), np.array([-1.0])),
                start=(np.zeros(1), 0.0), target=None,
            ),
            preset=preset, direction=1, box={0: (None, 6.0)}, metric=Euclidean(), max_step=10.0 * w,
        )  # fmt: skip
        fine = along(np.linspace(0.0, 6.0, 60_001))[1]
        assert len(path.turning_points) == np.count_nonzero(np.diff(np.sign(fine)))
