"""Models of the literature from Hopf point to Hopf point, or to a limit: with what the how-to says, and no more."""

import numpy as np
import pytest

import continuation
from continuation import Budget, Kind
from problems.orbits import PeriodicOrbit


def hodgkin_huxley(z, current):
    v, m, h, n = z
    a_m, b_m = 0.1 * (v + 40.0) / (1.0 - np.exp(-0.1 * (v + 40.0))), 4.0 * np.exp(-(v + 65.0) / 18.0)
    a_h, b_h = 0.07 * np.exp(-(v + 65.0) / 20.0), 1.0 / (1.0 + np.exp(-0.1 * (v + 35.0)))
    a_n, b_n = 0.01 * (v + 55.0) / (1.0 - np.exp(-0.1 * (v + 55.0))), 0.125 * np.exp(-(v + 65.0) / 80.0)
    flows = current - 120.0 * m**3 * h * (v - 50.0) - 36.0 * n**4 * (v + 77.0) - 0.3 * (v + 54.4)
    return np.stack([flows, a_m * (1.0 - m) - b_m * m, a_h * (1.0 - h) - b_h * h, a_n * (1.0 - n) - b_n * n])


def predator_and_prey(z, capacity):
    """Rosenzweig and MacArthur's."""
    x, y = z
    eaten = x * y / (1.0 + x)
    return np.stack([x * (1.0 - x / capacity) - eaten, 0.5 * eaten - 0.2 * y])


def cycles(f, start, target, intervals, box):
    rest = continuation.from_functions(f, start=start, target=target)
    path = continuation.trace(rest, observers=[continuation.Stability()])
    hopf = [event for event in path.events if event.kind == Kind.HOPF]
    orbit = PeriodicOrbit.from_hopf(f, hopf[0], intervals=intervals)
    followed = continuation.follow(orbit, start=orbit.leaving, budget=Budget(steps=200), box={"lam": box})
    return hopf, followed.path


def test_hodgkin_and_huxley():
    """Folds of cycles at 7.85, 7.92 and 6.26 (Rinzel and Miller, Math. Biosciences 49, 1980)."""
    hopf, path = cycles(hodgkin_huxley, ([-65.0, 0.05, 0.6, 0.32], 0.0), 200.0, 30, (0.0, 200.0))
    assert [event.lam for event in hopf] == pytest.approx([9.779338, 154.526334], abs=1e-5)
    folds = [event.lam for event in path.events if event.name == "turning point"]
    assert folds == pytest.approx([7.8462, 7.9217, 6.2642], abs=1e-3)
    assert {event.lam > 7.84 for event in path.events if event.name == "period doubling"} == {True}
    assert path.events[-1].name == "Hopf point"
    assert path.events[-1].lam == pytest.approx(hopf[1].lam, rel=1e-4)


def test_predator_and_prey():
    hopf, path = cycles(predator_and_prey, ([2.0 / 3.0, 5.0 / 9.0], 1.0), 6.0, 30, (0.1, 6.0))
    assert hopf[0].lam == pytest.approx(7.0 / 3.0, abs=1e-9)
    assert path.steps[-1].lam == 6.0
    assert path.steps[-1].observed["period"] == pytest.approx(41.36, abs=0.05)
    assert all(step.observed["unstable"] == 0.0 for step in path.steps)
