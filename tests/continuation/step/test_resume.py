"""A trace that goes on from any of its states is the same, bit for bit."""

import numpy as np
import pytest

from continuation import CONSERVATIVE, DEFAULT, FAST, Status, TargetValue, TurningPoint, trace
from problems.bifurcation import Bratu1D, Circle, FreudensteinRoth

from .util import CONTROLLERS, CORRECTORS, METRICS, PREDICTORS, Watcher

ONE_AT_A_TIME = (
    [{"predictor": predictor} for predictor in PREDICTORS]
    + [{"corrector": corrector} for corrector in CORRECTORS]
    + [{"controller": controller} for controller in CONTROLLERS]
    + [{"metric": metric} for metric in METRICS]
    + [{"preset": preset} for preset in (FAST, CONSERVATIVE)]
)


def assert_resumes_bit_for_bit(homotopy, **options):
    watcher = Watcher()
    path = trace(homotopy, observers=(watcher,), **options)
    # From every third: that each state leads to the next is tested with the archive's.
    for k, state in list(enumerate(watcher.states[:-1]))[::3]:
        resumed = trace(homotopy, state=state, **options)
        rest = path.steps[k + 1 :]
        assert len(resumed.steps) == len(rest)
        for mine, original in zip(resumed.steps, rest):
            np.testing.assert_array_equal(mine.u, original.u)
            np.testing.assert_array_equal(mine.tangent, original.tangent)
            same = ("index", "arclength", "step_length", "residual_norm", "orientation", "kind", "rejections", "angle")
            assert all(getattr(mine, name) == getattr(original, name) for name in same)
        later = [event for event in path.events if event.step > k]
        assert [event.name for event in resumed.events] == [event.name for event in later]
        for mine, original in zip(resumed.events, later):
            np.testing.assert_array_equal(mine.u, original.u)
        assert resumed.status is path.status
        # All but the one factorisation that restores the state was in the first trace too.
        assert resumed.counts.accepted == len(rest)


@pytest.mark.parametrize("options", ONE_AT_A_TIME, ids=repr)
def test_a_resumed_circle_is_the_same_bit_for_bit(options):
    assert_resumes_bit_for_bit(Circle(), events=[TargetValue(0.3, terminal=0)], **options)


@pytest.mark.parametrize("preset", [FAST, DEFAULT], ids=lambda preset: preset.name)
def test_a_resumed_path_with_rejections_is_the_same_bit_for_bit(preset):
    assert_resumes_bit_for_bit(FreudensteinRoth(), preset=preset, events=[TurningPoint(0)])


def test_a_resumed_path_of_a_band_is_the_same_bit_for_bit():
    assert_resumes_bit_for_bit(Bratu1D(30), events=[TargetValue(1.0, direction=-1)])


def test_a_resumed_trace_counts_its_events_on():
    watcher = Watcher()
    events = [TargetValue(0.3, terminal=2)]
    path = trace(Circle(), events=events, observers=(watcher,))
    first = next(event for event in path.events if event.name == "lam = 0.3")
    resumed = trace(Circle(), events=events, state=watcher.states[first.step])
    assert resumed.status is Status.STOPPED_AT_EVENT
    np.testing.assert_array_equal(resumed.endpoint.u, path.endpoint.u)
