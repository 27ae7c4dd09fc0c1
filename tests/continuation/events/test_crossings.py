"""Crossings: no branch switched in silence, none missed, none invented, no path stuck there."""

import numpy as np
import pytest

from continuation import (
    CONSERVATIVE,
    DEFAULT,
    FAST,
    SERIES,
    Budget,
    TargetValue,
    from_functions,
    trace,
)

from ...util import benchmark, by_preset, every_preset, path_of
from .util import branch_points, pitchfork, places, two_graphs

campaign = benchmark("crossings.py")


@every_preset
@pytest.mark.parametrize("y0", -np.random.default_rng(5).uniform(0.3, 3.0, 6))
def test_along_the_arm_of_a_pitchfork(preset, y0):
    homotopy = pitchfork(start=(y0, y0 * y0), target=None)
    events = [TargetValue(0.3, component=0), TargetValue(-2.0)]
    path = trace(homotopy, preset=preset, direction=-1, events=events, budget=Budget(steps=200))
    assert path.endpoint.y[0] == 0.3
    assert len(path.turning_points) == len(branch_points(path)) == 1
    assert abs(branch_points(path)[0].u).max() < 1e-10
    # The arm turns in the branch point: corrections beside it would lose half of the digits.
    np.testing.assert_array_equal(path.turning_points[0].u, branch_points(path)[0].u)
    # A target in the crossing itself.
    path = path_of(homotopy, preset=preset, target=0.0, budget=Budget(steps=200))
    assert abs(path.endpoint.u).max() < 1e-6


@every_preset
@pytest.mark.parametrize(("D", "L"), [(1.2e-10, 320.0), (8.3e-9, 4e4), (2.4e-8, 4.6e5), (1.6e-6, 2.9e5), (3e7, 1e-5)])
def test_a_trunk_that_stands_still_says_nothing_of_its_units(preset, D, L):
    # Measured by what the parameter goes, a step failed at the crossing, or put it 1e-4 off.
    at, k, c, b = -0.11892, 1.3, 20.3 * D, 1.97 * L

    def residual(y, lam):
        x, s = (y - c) / D, (lam - b) / L
        return 7.88 * x * (s - at - k * x * x)

    path = trace(from_functions(residual, start=([c], b - 1.3 * L), target=b + 1.5 * L), preset=preset)
    (event,) = branch_points(path)
    assert abs(event.y[0] - c) / D < 1e-10
    assert abs((event.lam - b) / L - at) < 1e-10


@every_preset
@pytest.mark.parametrize("seed", [605, 608, 671, 1084, 1377, 1483, 1738, 1981])
def test_a_target_just_before_a_crossing_lies_on_the_same_curve(preset, seed):
    # The curves are as near to each other there as the arc is to either: FAST ended on the other, and said nothing.
    rng = np.random.default_rng(seed)
    first = rng.normal(size=3)
    second, target = first + rng.normal(size=3), -(10.0 ** rng.uniform(-3.0, -0.7))
    f, g = (lambda s, c=c: c[0] * s + c[1] * s * s / 2.0 + c[2] * np.sin(s) for c in (first, second))
    path = path_of(two_graphs(f, g, -2.0, target), preset=preset)
    assert abs(path.endpoint.y[0] - f(target)) < 1e-9


@every_preset
@pytest.mark.parametrize("n", [5, 20])
@pytest.mark.parametrize(("scale", "origin"), [(1.0, 0.0), (1e-6, 2e-4)], ids=["plain", "shifted"])
def test_cells_that_are_all_alike(preset, scale, origin, n):
    """PITCON's problem 7. Of 20 cells 38 branch points, in pairs near each other: a look needs three dimensions."""
    M = 3.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    M[0, 0] = M[-1, -1] = 2.0

    def residual(y, lam):
        x = (y - origin) / scale
        return M @ x + 100.0 * x / (1.0 + x + x * x) - lam

    def jacobian(y, lam):
        x = (y - origin) / scale
        return (M + np.diag(100.0 * (1.0 - x * x) / (1.0 + x + x * x) ** 2)) / scale, -np.ones(n)

    homotopy = from_functions(residual, jacobian, start=(np.full(n, origin), 0.0), target=None)
    path = trace(homotopy, preset=preset, events=[TargetValue(40.0)])
    np.testing.assert_allclose([fold.lam for fold in path.turning_points], [34.356925, 18.887068], atol=1e-6)
    # Where 3 - 2 cos(k pi / n) + g(x) = 0, g the derivative of the reaction: in closed form by its roots.
    g = [3.0 - 2.0 * np.cos(k * np.pi / n) for k in range(1, n)]
    roots = np.ravel([np.roots([s, 2.0 * s, 3.0 * s - 100.0, 2.0 * s, s + 100.0]) for s in g])
    expected = np.sort(roots[(abs(roots.imag) < 1e-9) & (roots.real > 0.0)].real)
    found = [float(event.y[0] - origin) / scale for event in branch_points(path)]
    np.testing.assert_allclose(found, expected, rtol=1e-7 if origin else 1e-10)


@by_preset(FAST, DEFAULT)
@pytest.mark.parametrize("family", ["transversal", "pitchfork", "transcritical"])
def test_random_crossings_in_random_units(family, preset):
    rng = np.random.default_rng(21)
    for _ in range(4):
        problem = campaign.FAMILIES[family](rng, int(rng.integers(1, 9)), float(rng.choice([0.0, 6.0])))
        assert campaign.judged(problem, preset)[0] == ""


# -- two crossings near each other, or in one step: both are seen, and the path stays on its branch -----------------


@pytest.mark.parametrize(
    ("family", "seed", "k", "preset"),
    [
        # Each of these left its graph at the second crossing, or (the last) stopped in the first one.
        ("transversal", 777, 480, DEFAULT),
        ("transversal", 777, 641, CONSERVATIVE),
        ("apart", 888, 443, DEFAULT),
        ("apart", 888, 830, FAST),
        ("apart", 888, 151, SERIES),
        # Half way over the first H' is as it was or farther from singular; the other was out of sight of one vector.
        ("apart", 912, 168, DEFAULT),
        ("pairs", 4004, 163, DEFAULT),
        ("pairs", 4004, 163, CONSERVATIVE),
        # Newton's method stopped 3e-8 from the crossing, at which its next increment would have been round-off.
        ("transversal", 5005, 262, SERIES),
    ],
    ids=lambda value: getattr(value, "name", str(value)),
)
def test_crossings_that_a_path_was_lost_at(family, seed, k, preset):
    *_, problem = campaign.drawn(family, k + 1, seed)
    wrong, error, _ = campaign.judged(problem, preset)
    assert wrong == ""
    assert error < 1e-9


@every_preset
@pytest.mark.parametrize(("first", "gap"), [(-0.37, 0.034), (0.61, 0.034), (0.26, 0.01), (0.965, 0.0094)])
def test_a_trunk_crossed_twice_within_a_step(first, gap, preset):
    """The determinant's sign is the same on both sides."""
    path = path_of(two_graphs(lambda t: 0.0 * t, lambda t: (t - first) * (t - first - gap), -2.0), preset=preset)
    assert places(path) == pytest.approx([first, first + gap], abs=1e-11)


def test_a_graph_is_not_left_where_a_prediction_lands_on_the_other():
    """Behind the crossing at -0.103 the two are nearer than a prediction is to either, which the corrector likes."""
    own, other = np.array([1.8268, -3.0783, 0.9581]), np.array([0.00696, 0.13183, 0.03856])
    f, g = (
        lambda t, c=c: c[0] * t + c[1] * t**2 * 0.5 + c[2] * (np.sin(2.0 * t) - 2.0 * t) * 0.3
        for c in (own, own + other)
    )
    path = trace(two_graphs(f, g, -1.9317))
    assert places(path) == pytest.approx([-0.103108114843, 0.0], abs=1e-11)
    assert path.endpoint.y[0] == pytest.approx(f(2.0))


@pytest.mark.parametrize(
    ("c", "pair", "last"), [(2.5, 0.02, 0.8), (0.25, 0.02, 0.8), (1.43, 0.05, 1.1), (2.93, 0.01, 0.93)]
)
def test_a_pair_of_crossings_in_a_long_step_of_a_series(c, pair, last):
    """The first two were passed between two looks, or all as one."""

    def f(t):
        return -0.8 * t - 0.1 * np.sin(2.0 * t)

    path = trace(two_graphs(f, lambda t: f(t) + c * t * (t - pair) * (t - last), -2.0), preset=SERIES)
    assert places(path) == pytest.approx([0.0, pair, last], abs=1e-11)
    assert path.endpoint.y[0] == pytest.approx(f(2.0))
