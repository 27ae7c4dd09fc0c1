"""The aircraft at a high angle of attack: the limit points of the tables, for every elevator."""

import numpy as np
import pytest

from continuation import Status, TurningPoint, trace
from continuation.auditing import audit
from problems.bifurcation import Aircraft
from tests.truth import aircraft

from ..util import every_preset

# Columns e, x1, ..., x5, x7 as published, ten digits.
TABLE = np.array(
    [
        [-0.05, 2.9648667005, 0.8255649586, 0.0736608584, 0.0413095110, 0.2673494385, -0.5048105071],
        [-0.008, 2.8173821233, -0.1762890924, 0.0899263306, 0.0264294197, -0.0714757542, -0.2049730046],
        [-0.008, 3.7579236986, -0.6554237036, 0.3865839959, 0.0925213059, -0.1986738075, 0.0062082071],
        [-0.008, 4.1638336617, 0.0891314590, 0.0948064469, 0.0228891194, 0.0162317578, -0.3776599599],
        [0.0, 2.5873297608, -0.2235486659, 0.0546825844, 0.0136762062, -0.0916871424, -0.1869083327],
        [0.0, 3.9005105286, -1.1481497858, 0.5815638232, 0.1335164795, -0.3285893618, 0.5101585347],
        [0.05, 2.3639816884, -0.7297416687, -0.0316049355, -0.0387859094, -0.2958380612, -0.2957724043],
        [0.1, 2.2992230670, -1.4102337541, -0.0618485942, -0.0790091013, -0.5862957241, -0.6897171901],
    ]
)

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


@every_elevator
def test_as_published(elevator):
    rows = TABLE[TABLE[:, 0] == elevator, 1:]
    path = trace(Aircraft(elevator), direction=-1, events=[TurningPoint(terminal=len(rows))])
    np.testing.assert_allclose([event.u for event in path.turning_points], rows, rtol=0, atol=1e-10)


@every_elevator
def test_no_jump(elevator):
    path = trace(Aircraft(elevator), direction=-1, events=[TurningPoint(terminal=len(aircraft.limit_points(elevator)))])
    assert audit(Aircraft(elevator), path).same
