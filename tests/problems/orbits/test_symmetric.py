"""Orbits that the parameter does not move: a circle beside which other unknowns are zero, or constant, by symmetry."""

import numpy as np
import pytest

import continuation
from continuation import Status, TargetValue
from problems.orbits import PeriodicOrbit

from ...util import path_of

TURN = {"branch point": 0.0, "period doubling": 0.5, "torus": 0.35}
"""How often what is beside the circle turns while that is passed once."""

RATE, PERIOD = 300.0, 2.0 * np.pi / 400.0


def model(name, units, middle, Q):
    """At p = 0 the circle u^2 + v^2 = 1 loses stability; beside it then a^2 + b^2 = p."""

    def f(x, p):
        y = [x[i] / units[i] - middle[i] for i in range(4)]
        u, v, a, b = (sum(Q[j, i] * y[j] for j in range(4)) for i in range(4))
        grows, turn, n = RATE * (1.0 - u * u - v * v), 400.0 * TURN[name], RATE * (a * a + b * b)
        mean, half = (RATE * p, 0.0) if name == "torus" else (0.5 * RATE * (p - 0.8), 0.5 * RATE * (p + 0.8))
        C, s = (u, v) if name == "period doubling" else (1.0, 0.0)
        z = [
            grows * u - 400.0 * v,
            400.0 * u + grows * v,
            -turn * b + (mean - n) * a + half * (C * a + s * b),
            turn * a + (mean - n) * b + half * (s * a - C * b),
        ]
        return np.stack([units[i] * sum(Q[i, j] * z[j] for j in range(4)) for i in range(4)])

    return f


@pytest.mark.parametrize("name", TURN)
@pytest.mark.parametrize("kind", ["mixed", "constant", "decayed"])
def test_an_orbit_loses_stability_where_no_parameter_moves_it(name, kind):
    generator = np.random.default_rng(len(name) + len(kind))
    units = 10.0 ** generator.uniform(-3.0, 3.0, 4)
    Q = np.linalg.qr(generator.normal(size=(4, 4)))[0] if kind == "mixed" else np.eye(4)
    middle = generator.normal(size=4) if kind == "constant" else np.zeros(4)
    t = np.linspace(0.0, 2.2 * PERIOD, 400)
    beside = 1e-18 * np.cos(np.outer([0.7, 1.1], np.arange(400.0))) if kind == "decayed" else np.zeros((2, 400))
    z = np.vstack([np.cos(400.0 * t), np.sin(400.0 * t), beside])
    f = model(name, units, middle, Q)
    orbit = PeriodicOrbit.from_solution(f, t, units * ((Q @ z).T + middle), -0.3, intervals=14)
    path = continuation.trace(orbit, direction=1, events=[TargetValue(0.4)])
    lost, _ = path.events
    assert name in lost.name
    # A constant circle is a straight path; its first step, of 2e9, has forty crossings, whose search took 300 solves.
    assert path.counts.solves < 6000
    assert lost.lam == pytest.approx(0.0, abs=1e-9)
    assert [path.steps[k].observed["unstable"] for k in (0, -1)] == [0.0, 2.0 if name == "torus" else 1.0]
    # What is beside the circle: where it loses stability, before it anywhere.
    crossing = orbit.multipliers(lost.y, lost.lam).values[1]
    assert abs(np.angle(crossing)) == pytest.approx(2.0 * np.pi * TURN[name], abs=1e-6)
    if name == "torus":
        return
    if name == "period doubling":
        orbit = orbit.doubled(lost)
        starts = [orbit.leaving]
    else:
        starts = continuation.switch_branch(orbit, lost)
    for start in starts:
        branch = path_of(orbit, start=start, events=[TargetValue(0.3)], status=Status.STOPPED_AT_EVENT)
        x = orbit.at(branch.endpoint.y, np.linspace(0.0, 1.0, 201)) / units - middle
        assert np.hypot(*(x @ Q).T[2:]).max() == pytest.approx(np.sqrt(0.3), rel=1e-4)
