"""Orbits that are known: in closed form, or by DOP853 at 1e-13 and Newton's method on the return."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import continuation
from continuation import TargetValue
from problems.orbits import PeriodicOrbit
from problems.orbits.models import brusselator, normal_form, roessler, van_der_pol

from ...util import path_of
from .util import bent, by_hand, of_sizes, one_by_one, simulated, two_circles


@pytest.mark.parametrize(
    ("f", "jacobian", "accuracy"),
    [(normal_form, None, 1e-12), (normal_form, by_hand, 1e-12), (bent, None, 1e-10), (one_by_one, None, 1e-12),
     (of_sizes, None, 1e-9)],
)  # fmt: skip
def test_the_normal_form_from_its_hopf_point_over_the_fold(f, jacobian, accuracy):
    intervals = 40 if f is bent else 20
    orbit = PeriodicOrbit.from_hopf(f, ([0.0, 0.0], 0.0), intervals=intervals, jacobian=jacobian)
    path = continuation.trace(orbit, start=orbit.leaving, events=[TargetValue(0.2)])
    fold, end = path.events
    assert fold.name == "turning point"
    assert fold.lam == pytest.approx(-0.25, abs=accuracy)
    assert fold.observed["period"] == pytest.approx(2.0 * np.pi, rel=1e-8)
    assert fold.observed["trivial"] < 1e-6
    r2 = 0.5 * (1.0 + np.sqrt(1.8))
    assert end.observed["max 0"] == pytest.approx(np.sqrt(r2), rel=1e-6)
    assert end.observed["multiplier"] == pytest.approx(np.exp(2.0 * np.pi * (0.2 + 3.0 * r2 - 5.0 * r2**2)), rel=1e-6)
    assert [step.observed["unstable"] for step in path.steps] == sorted(
        (step.observed["unstable"] for step in path.steps), reverse=True
    )


def spiral(S, w=1.0, L=1.0, off=(0.0, 0.0, 0.0)):
    """A supercritical Hopf point at zero, in units S of the state, w of time and L of the parameter, moved by `off`."""

    def f(x, p):
        u, v, z = (x[i] / S[i] - off[i] for i in range(3))
        q, mu = u * u + v * v, p / L
        return w * np.stack([S[0] * ((mu - q) * u - v), S[1] * (u + (mu - q) * v), S[2] * (0.3 * u * v - z)])

    return f


@pytest.mark.parametrize("left", [[0.0, 0.0, 0.0], [8.2e-39, 4.2e-36, 4.3e-75], [1e-300, 1e-36, 1e-120]])
def test_what_a_solver_left_of_zeros_sets_no_sizes(left):
    orbit = PeriodicOrbit.from_hopf(spiral([1e-3, 1.0, 100.0]), (left, 0.0), intervals=12)
    assert orbit.period == pytest.approx(2.0 * np.pi, rel=1e-6)
    path = continuation.trace(orbit, start=orbit.leaving, budget=continuation.Budget(steps=8))
    assert len(path) == 9


@pytest.mark.parametrize(
    ("f", "p", "x0", "period", "multiplier", "accuracy"),
    [(van_der_pol, 1.0, [2.0, 0.0], 6.663286859323131, 8.596951e-4, 1e-8),
     (van_der_pol, 10.0, [2.0, 0.0], 19.078369566939067, 0.0, 1e-4),
     (brusselator, 3.0, [1.0, 2.9], 7.156919921179888, 2.5163758e-4, 1e-8)],
)  # fmt: skip
def test_a_simulation_settles_on(f, p, x0, period, multiplier, accuracy):
    orbit = PeriodicOrbit.from_solution(f, *simulated(f, p, x0), p, intervals=40)
    assert orbit.period == pytest.approx(period, rel=1e-8)
    found = orbit.multipliers(*orbit.start()).values
    assert abs(found[0] - 1.0) <= accuracy
    assert_allclose(found[1:], multiplier, atol=2e-7 * multiplier + 1e-14)


@pytest.mark.parametrize("rounds", [1.0, 0.99, 1.5])
@pytest.mark.parametrize("phase", [0.0, 1.0, 4.0])
def test_one_period_is_enough_of_a_simulation(rounds, phase):
    t = np.linspace(0.0, 2.0 * np.pi * rounds, 90)
    x = np.stack([np.cos(t + phase), np.sin(t + phase), 0.0 * t, 0.0 * t], axis=1)
    assert PeriodicOrbit.from_solution(two_circles, t, x, -0.5).period == pytest.approx(2.0 * np.pi, rel=1e-9)


def test_the_first_period_doubling_of_roessler():
    orbit = PeriodicOrbit.from_solution(roessler, *simulated(roessler, 2.7, [1.0, 1.0, 0.1], 500.0), 2.7, intervals=40)
    path = continuation.trace(orbit, direction=1, events=[TargetValue(3.0)])
    doubling = path.events[0]
    assert doubling.name == "period doubling"
    assert doubling.lam == pytest.approx(2.832445027862, abs=1e-8)
    assert doubling.observed["period"] == pytest.approx(5.769820016507, abs=1e-8)
    assert doubling.observed["trivial"] <= 1e-8
    assert [step.observed["unstable"] for step in path.steps] == [0.0] * (len(path) - 1) + [1.0]
    twice = orbit.doubled(doubling)
    assert twice.period == pytest.approx(2.0 * 5.7698, abs=1e-3)
    branch = path_of(twice, start=twice.leaving, events=[TargetValue(3.0)], status=continuation.Status.STOPPED_AT_EVENT)
    assert branch.steps[-1].observed["unstable"] == 0.0


@pytest.mark.parametrize(("degree", "order"), [(2, 4), (3, 6), (4, 8)])
def test_the_period_converges_twice_as_fast_as_the_degree(degree, order):
    times, states = simulated(van_der_pol, 1.0, [2.0, 0.0])
    errors = []
    for intervals in (12, 24):
        orbit = PeriodicOrbit.from_solution(van_der_pol, times, states, 1.0, intervals=intervals, degree=degree)
        errors.append(abs(orbit.period - 6.663286859323131))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=1.5)


def test_the_bound_holds_between_the_mesh_points():
    orbit = PeriodicOrbit.from_hopf(normal_form, ([0.0, 0.0], 0.0), intervals=8, radius=0.3)
    radii = np.linalg.norm(orbit.at(orbit.start()[0], np.linspace(0.0, 1.0, 500)), axis=1)
    r2 = 0.5 * (1.0 - np.sqrt(1.0 + 4.0 * orbit.parameter))
    error = np.abs(radii - np.sqrt(r2)).max()
    assert 0.0 < error <= orbit.observe(*orbit.start())["error"]


@pytest.mark.parametrize("seed", range(6))
def test_the_first_orbit_does_not_depend_on_units_or_origin(seed):
    """A Hopf point at zero says nothing of the size of its orbits, and one far away too much."""
    r = np.random.default_rng([5, seed])
    S, w, L = 10.0 ** r.uniform(-4, 4, 3), 10.0 ** r.uniform(-3, 3), 10.0 ** r.uniform(-3, 3)
    off = np.array([0.0, 1.0, 1e4])[seed % 3] * r.normal(size=3)
    f = spiral(S, w, L, off)
    rest = continuation.from_functions(f, start=(S * off, -L), target=L)
    (hopf,) = (event for event in continuation.trace(rest, observers=[continuation.Stability()]).events)
    orbit = PeriodicOrbit.from_hopf(f, hopf, intervals=10)
    path = path_of(orbit, start=orbit.leaving, target=L)
    for step in path.steps:
        seen = step.observed
        amplitude = 0.5 * (seen["max 0"] - seen["min 0"]) / S[0]
        assert amplitude == pytest.approx(np.sqrt(step.lam / L), rel=1e-3)
        assert seen["period"] == pytest.approx(2.0 * np.pi / w, rel=1e-6)
