"""The aircraft at a high angle of attack: the limit points of the tables, for every elevator."""

import numpy as np
import pytest

from continuation import Status, TurningPoint, trace
from problems.bifurcation import Aircraft
from tests.truth import aircraft

from ..util import every_preset

every_elevator = pytest.mark.parametrize("elevator", aircraft.ELEVATORS)


@every_elevator
@every_preset
@pytest.mark.parametrize("aileron", ["falling", "rising"])
def test_every_limit_point_in_order(elevator, preset, aileron):
    expected = aircraft.limit_points(elevator, aileron)
    path = trace(
        Aircraft(elevator),
        direction=-1 if aileron == "falling" else 1,
        events=[TurningPoint(terminal=len(expected))],
        preset=preset,
    )
    assert path.status is Status.STOPPED_AT_EVENT
    np.testing.assert_allclose([event.u for event in path.turning_points], expected, rtol=0, atol=1e-10)
