"""A trace that goes on from any of its states is the same, bit for bit; the archive's tests try every part."""

import numpy as np
import pytest

from continuation import FAST, Status, TargetValue, TurningPoint, trace
from problems.bifurcation import Bratu1D, Circle, FreudensteinRoth

from .util import METRICS, Watcher

SAME = ("index", "arclength", "step_length", "residual_norm", "orientation", "kind", "rejections", "angle")


@pytest.mark.parametrize(
    ("homotopy", "options"),
    [
        *((Circle(), {"metric": metric, "events": [TargetValue(0.3, terminal=0)]}) for metric in METRICS),
        (Circle(), {"events": [TargetValue(0.3, terminal=2)]}),
        (FreudensteinRoth(), {"events": [TurningPoint(0)]}),
        (FreudensteinRoth(), {"events": [TurningPoint(0)], "preset": FAST}),
        (Bratu1D(30), {"events": [TargetValue(1.0, direction=-1)]}),
    ],
)
def test_a_resumed_path_is_the_same_bit_for_bit(homotopy, options):
    watcher = Watcher()
    path = trace(homotopy, observers=(watcher,), **options)
    # From every third: that each state leads to the next is tested with the archive's.
    for k, state in list(enumerate(watcher.states[:-1]))[::3]:
        resumed, rest = trace(homotopy, state=state, **options), path.steps[k + 1 :]
        np.testing.assert_array_equal(resumed.u, path.u[k + 1 :])
        np.testing.assert_array_equal(resumed.tangents, path.tangents[k + 1 :])
        for name in SAME:
            assert [getattr(step, name) for step in resumed.steps] == [getattr(step, name) for step in rest]
        later = [(event.name, *event.u) for event in path.events if event.step > k]
        assert [(event.name, *event.u) for event in resumed.events] == later
        assert resumed.status is path.status
        # All but the one factorisation that restores the state was in the first trace too.
        assert resumed.counts.accepted == len(rest)
    assert path.status in (Status.CLOSED, Status.STOPPED_AT_EVENT, Status.REACHED_TARGET)
