"""The loop: every pair of parts, what a path is, iteration, observers and clocks."""

from itertools import product
from math import pi

import numpy as np
import pytest

from continuation import (
    CONSERVATIVE,
    DEFAULT,
    FAST,
    SERIES,
    Budget,
    Kind,
    Status,
    Tracer,
    from_functions,
    trace,
)
from continuation.correctors import NaturalParameter
from continuation.metric import Euclidean
from continuation.rejection import Rejection
from problems.bifurcation import Circle, Cusp, FreudensteinRoth

from ...util import by_preset, every_preset, path_of
from .util import CONTROLLERS, CORRECTORS, METRICS, PREDICTORS, Watcher

# Every pair of parts occurs: the numbers of predictor, corrector and controller make a Latin square.
PAIRWISE = [
    (predictor, corrector, CONTROLLERS[(i + j) % len(CONTROLLERS)])
    for (i, predictor), (j, corrector) in product(enumerate(PREDICTORS), enumerate(CORRECTORS))
]


@pytest.mark.parametrize(("predictor", "corrector", "controller"), PAIRWISE, ids=repr)
def test_every_pair_of_parts_goes_round_the_circle(predictor, corrector, controller):
    path = path_of(
        Circle(),
        predictor=predictor,
        corrector=corrector,
        controller=controller,
        metric=Euclidean(),
        status=Status.CLOSED,
    )
    assert [round(event.lam, 9) for event in path.turning_points] == [1.0, -1.0]
    assert path.endpoint.arclength == pytest.approx(2.0 * pi, rel=1e-4)
    assert np.abs(np.hypot(path.y[:, 0], path.lam) - 1.0).max() <= 1e-7


@pytest.mark.parametrize(("predictor", "controller"), [(p, c) for p, _, c in PAIRWISE], ids=repr)
def test_the_natural_parameter_follows_what_does_not_turn(predictor, controller):
    path = path_of(Cusp(-0.7), predictor=predictor, corrector=NaturalParameter(), controller=controller)
    np.testing.assert_allclose(path.endpoint.y, 1.0 + np.sqrt(0.7), rtol=1e-8)


@pytest.mark.parametrize("metric", METRICS, ids=repr)
@every_preset
def test_every_metric_follows_the_cusp(metric, preset):
    path = path_of(Cusp(), metric=metric, preset=preset)
    np.testing.assert_allclose(path.endpoint.u, (2.0, 6.0), rtol=1e-8)
    assert len(path.turning_points) == 2


def test_the_records_of_a_path_agree():
    path, homotopy = trace(FreudensteinRoth(), metric=Euclidean()), FreudensteinRoth()
    m = len(path)
    assert (path.y.shape, path.lam.shape, path.arclength.shape) == ((m, 2), (m,), (m,))
    assert [step.index for step in path.steps] == list(range(m))
    assert [path.steps[0].kind, path.endpoint.kind] == [Kind.START, Kind.TARGET]
    assert (np.diff(path.arclength) > 0.0).all()
    # The end is landed on at a fixed parameter; its determinant may be left unknown.
    assert {step.orientation for step in path.steps[:-1]} in ({1}, {-1})
    for step in path.steps[:-1]:
        whole = np.column_stack(homotopy.jacobian(step.y, step.lam))
        assert np.abs(whole @ step.tangent).max() <= 1e-9 * np.abs(whole).max()
        assert np.linalg.norm(step.tangent) == pytest.approx(1.0, rel=1e-12)
        assert np.sign(np.linalg.det(np.vstack((whole, step.tangent)))) == step.orientation
        assert step.share == pytest.approx(step.tangent[-1] ** 2, rel=1e-9)
        assert step.residual_norm == np.abs(homotopy.residual(step.y, step.lam)).max() <= 1e-6


@pytest.mark.parametrize(("preset", "off"), [(DEFAULT, 3e-4), (SERIES, 1e-6)], ids=["DEFAULT", "SERIES"])
def test_dense_output_is_close_to_the_path(preset, off):
    path = trace(Circle(), metric=Euclidean(), preset=preset)
    s = np.linspace(0.0, path.endpoint.arclength, 200)
    np.testing.assert_allclose(path(s), np.column_stack((np.cos(s), np.sin(s))), rtol=0, atol=off)
    np.testing.assert_array_equal(path(0.0), path.steps[0].u)
    with pytest.raises(ValueError, match="s: expected values in"):
        path(path.endpoint.arclength + 1.0)


def test_a_loop_that_was_left_goes_on_and_hands_out_every_step_once():
    tracer, whole = Tracer(FreudensteinRoth()), trace(FreudensteinRoth())
    iter(tracer).close()
    seen = []
    while not tracer.path.success:
        for step in tracer:
            seen.append(step.index)
            if step.index % 4 == 1:
                break
        assert tracer.path.status in (Status.ABANDONED, whole.status)
        assert len(tracer.path) == len(seen)
    assert seen == list(range(len(whole)))
    assert tracer.path.message == whole.message
    np.testing.assert_array_equal(tracer.path.u, whole.u)
    assert list(tracer) == []


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
    assert (tracer.path.status, len(tracer.path)) == (Status.BUDGET_EXHAUSTED, 10)
    assert tracer.path.seconds == 100.0
    # The budget of a resumed path counts from then on.
    rest = Tracer(Cusp(), preset=CONSERVATIVE, budget=Budget(seconds=30.0), state=tracer.state)
    for _ in rest:
        clock.now += 10.0
    assert [step.index for step in rest.path.steps] == [10, 11, 12]


def test_observers_see_all_of_it_in_order():
    watcher = Watcher()
    path = trace(Cusp(), observers=(watcher,))
    assert [what for what in watcher.seen if what[0] == "step"] == [("step", k) for k in range(len(path))]
    assert watcher.seen[-1] == ("end", Status.REACHED_TARGET)
    # An event comes before the step that holds it.
    before = [watcher.seen[k + 1] for k, what in enumerate(watcher.seen) if what[0] == "event"]
    assert before == [("step", event.step) for event in path.events]


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


def test_an_unexamined_trace_follows_the_same_path_for_less():
    """Steps are those of a full trace up to the end; no turning point is located, and that is what is saved."""
    full, light = (trace(FreudensteinRoth(), examine=examine) for examine in (True, False))
    assert (light.status, len(light), light.events) == (full.status, len(full), [])
    assert len(full.turning_points) > 0
    np.testing.assert_allclose(light.endpoint.u, full.endpoint.u, rtol=0, atol=1e-10)
    assert light.counts.solves < full.counts.solves
    assert light.counts.residuals < full.counts.residuals


def bent(seed, w=0.02):
    """An S as wide as w, without a shift: no look sees it that is not inside of it (docs/guarantee.md)."""
    rng = np.random.default_rng([55, seed])
    c, k, a = rng.uniform(2.0, 4.0), rng.uniform(2.0, 5.0), rng.uniform(0.2, 0.8)

    def along(y):
        x = (y - c) / w
        bump = np.exp(-(x**2))
        return y + a * np.sin(y) - w * k * x * bump, 1.0 + a * np.cos(y) - k * (1.0 - 2.0 * x * x) * bump

    return along


@by_preset(FAST, DEFAULT)
@pytest.mark.parametrize("seed", range(6))
def test_bends_as_wide_as_the_resolution_are_not_missed(preset, seed):
    along = bent(seed)
    homotopy = from_functions(
        lambda y, lam: along(y)[0] - lam,
        lambda y, lam: (np.diag(along(y)[1]), np.array([-1.0])),
        start=(np.zeros(1), 0.0),
        target=None,
    )
    path = trace(homotopy, preset=preset, direction=1, box={0: (None, 6.0)}, metric=Euclidean(), max_step=0.2)
    fine = along(np.linspace(0.0, 6.0, 60_001))[1]
    assert len(path.turning_points) == np.count_nonzero(np.diff(np.sign(fine)))
