"""Crossings: no branch switched in silence, none missed, none invented, no path stuck there."""

import warnings

import numpy as np
import pytest
import scipy.sparse as sp

import continuation
from continuation import Budget, Kind, Status, TargetValue, TurningPoint, from_functions, switch_branch, trace
from continuation.archive import open_archive
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.events.singularity import branch_point_near, row_sizes

from ...util import benchmark, every_preset

campaign = benchmark("crossings.py")


def branch_points(path):
    return [event for event in path.events if event.kind == Kind.BRANCH_POINT]


def pitchfork(y0):
    """Along the arm lam = y^2: at (0, 0) it crosses the trunk y = 0, and its parameter turns."""
    return from_functions(
        lambda y, lam: np.stack([lam * y[0] - y[0] ** 3]),
        lambda y, lam: (np.array([[lam - 3.0 * y[0] ** 2]]), np.array([y[0]])),
        start=([y0], y0 * y0),
        target=None,
    )


@every_preset
def test_along_the_arm_of_a_pitchfork(preset):
    for y0 in -np.random.default_rng(5).uniform(0.3, 3.0, 12):
        events = [TargetValue(0.3, component=0), TargetValue(-2.0)]
        path = trace(pitchfork(y0), preset=preset, direction=-1, events=events, budget=Budget(steps=200))
        assert path.endpoint.y[0] == 0.3
        assert len(path.turning_points) == len(branch_points(path)) == 1
        assert abs(branch_points(path)[0].u).max() < 1e-10


@every_preset
def test_a_target_in_the_crossing_itself(preset):
    for y0 in -np.random.default_rng(6).uniform(0.3, 3.0, 12):
        path = trace(pitchfork(y0), preset=preset, target=0.0, budget=Budget(steps=200))
        assert path.status is Status.REACHED_TARGET
        assert abs(path.endpoint.u).max() < 1e-6


@every_preset
@pytest.mark.parametrize(("D", "L"), [(1.2e-10, 320.0), (8.3e-9, 4e4), (2.4e-8, 4.6e5), (1.6e-6, 2.9e5), (3e7, 1e-5)])
def test_a_trunk_that_stands_still_says_nothing_of_its_units(preset, D, L):
    # Measured by what the parameter goes, a step failed at the crossing, or put it 1e-4 off.
    at, k, c, b = -0.11892, 1.3, 20.3 * D, 1.97 * L

    def residual(y, lam):
        x, s = (y - c) / D, (lam - b) / L
        return 7.88 * x * (s - at - k * x * x)

    def jacobian(y, lam):
        x, s = (y[0] - c) / D, (lam - b) / L
        return np.array([[7.88 * (s - at - 3.0 * k * x * x) / D]]), np.array([7.88 * x / L])

    start = ([c], b - 1.3 * L)
    path = trace(from_functions(residual, jacobian, start=start, target=b + 1.5 * L), preset=preset)
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

    def graph(c, s):
        return c[0] * s + c[1] * s * s / 2.0 + c[2] * np.sin(s)

    def residual(y, s):
        return (y - graph(first, s)) * (y - graph(second, s))

    path = trace(from_functions(residual, start=([graph(first, -2.0)], -2.0), target=target), preset=preset)
    assert path.status is Status.REACHED_TARGET
    assert abs(path.endpoint.y[0] - graph(first, target)) < 1e-9


def ten(preset, target=10.5):
    """Ten pitchforks on a straight trunk, at lam = 1 .. 10."""
    k = np.arange(1.0, 11.0)
    homotopy = from_functions(
        lambda y, lam: (lam - k) * y - y**3,
        lambda y, lam: (np.diag(lam - k - 3.0 * y**2), y),
        start=(np.zeros(10), 0.0),
        target=target,
    )
    return trace(homotopy, preset=preset)


@every_preset
def test_ten_on_a_straight_trunk(preset):
    np.testing.assert_allclose([event.lam for event in branch_points(ten(preset))], np.arange(1.0, 11.0), atol=1e-12)


def cells(n, preset, scale=1.0, origin=0.0):
    """A chain of n cells, all alike on the trunk (PITCON's problem 7, in any unit)."""
    M = 3.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    M[0, 0] = M[-1, -1] = 2.0

    def residual(y, lam):
        x = (y - origin) / scale
        return M @ x + 100.0 * x / (1.0 + x + x * x) - lam

    def jacobian(y, lam):
        x = (y - origin) / scale
        return (M + np.diag(100.0 * (1.0 - x * x) / (1.0 + x + x * x) ** 2)) / scale, -np.ones(n)

    homotopy = from_functions(residual, jacobian, start=(np.full(n, origin), 0.0), target=None)
    return trace(homotopy, preset=preset, events=[TargetValue(40.0)])


@every_preset
@pytest.mark.parametrize("n", [5, 20])
@pytest.mark.parametrize("units", [(1.0, 0.0), (1e-6, 2e-4)], ids=["plain", "shifted"])
def test_cells_that_are_all_alike(preset, units, n):
    """Of 20 cells 38 branch points, in pairs that lie near each other: the look along a step needs three dimensions."""
    path = cells(n, preset, *units)
    assert path.status is Status.STOPPED_AT_EVENT
    np.testing.assert_allclose([fold.lam for fold in path.turning_points], [34.356925, 18.887068], atol=1e-6)
    # Where 3 - 2 cos(k pi / n) + g(x) = 0, g the derivative of the reaction: in closed form by its roots.
    g = [3.0 - 2.0 * np.cos(k * np.pi / n) for k in range(1, n)]
    expected = sorted(
        float(x.real)
        for s in g
        for x in np.roots([s, 2.0 * s, 3.0 * s - 100.0, 2.0 * s, s + 100.0])
        if abs(x.imag) < 1e-9 and x.real > 0.0
    )
    found = [float(event.y[0] - units[1]) / units[0] for event in branch_points(path)]
    np.testing.assert_allclose(found, expected, rtol=1e-7 if units[1] else 1e-10)


@every_preset
@pytest.mark.parametrize("a", [0.1, 0.02, 0.005])
def test_neighbouring_circles_do_not_cross(preset, a):
    """sin((r - 1) / a) = 0 holds on all circles r = 1 + k pi a."""

    def jacobian(y, lam):
        r = np.hypot(y[0], lam)
        c = np.cos((r - 1.0) / a) / (a * r)
        return np.array([[c * y[0]]]), np.array([c * lam])

    def residual(y, lam):
        return np.stack([np.sin((np.sqrt(y[0] ** 2 + lam**2) - 1.0) / a)])

    homotopy = from_functions(residual, jacobian, start=([1.0], 0.0), target=None)
    path = trace(homotopy, preset=preset, budget=Budget(steps=400))
    assert path.status is Status.CLOSED
    assert not branch_points(path)
    assert len(path.turning_points) == 2
    np.testing.assert_allclose(np.hypot(path.y[:, 0], path.lam), 1.0, rtol=0, atol=1e-9)


@every_preset
def test_five_on_the_trunk_of_a_boundary_value_problem(preset):
    """u'' + (p pi)^2 u - u^2 = 0, u = 0 at 0 and 1, finite differences: where p pi is the root of an eigenvalue."""
    n = 40
    h = 1.0 / (n + 1)
    L = sp.diags_array([np.ones(n - 1), -2.0 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]).tocsc() / h**2

    def jacobian(y, p):
        return sp.csc_array(L + sp.diags_array((p * np.pi) ** 2 - 2.0 * y)), 2.0 * p * np.pi**2 * y

    homotopy = from_functions(
        lambda y, p: y @ L + (p * np.pi) ** 2 * y - y**2, jacobian, start=(np.zeros(n), 0.5), target=5.5
    )
    expected = [2.0 / h * np.sin(0.5 * k * np.pi * h) / np.pi for k in range(1, 6)]
    path = trace(homotopy, preset=preset)
    np.testing.assert_allclose([event.lam for event in branch_points(path)], expected, rtol=1e-10)


def mittelmann(m):
    """u = lam exp(u) on m x m cells without flux, whose constant branch is crossed by patterns."""
    T = sp.diags([np.ones(m - 1), -2.0 * np.ones(m), np.ones(m - 1)], [-1, 0, 1]).tolil()
    T[0, 0] = T[m - 1, m - 1] = -1.0
    L = sp.csc_array((sp.kron(T, sp.identity(m)) + sp.kron(sp.identity(m), T)) * m * m)
    return from_functions(
        lambda u, lam: u @ L.T - 10.0 * (u - lam * np.exp(u)),
        lambda u, lam: (sp.csc_array(L - sp.diags_array(10.0 - 10.0 * lam * np.exp(u))), 10.0 * np.exp(u)),
        start=(np.zeros(m * m), 0.0),
        target=None,
    )


@pytest.mark.parametrize("step", [1e-2, 0.1])
def test_the_arms_of_a_crossing_are_followed_over_the_next(step):
    homotopy = mittelmann(8)
    trunk = trace(homotopy, events=[TargetValue(0.1, direction=-1)])
    (first, *_) = branch_points(trunk)
    for start in switch_branch(homotopy, first, step):
        path = trace(homotopy, start=start, events=[TurningPoint(terminal=1)], budget=Budget(steps=150))
        assert path.status is not Status.STEP_TOO_SMALL
        assert start[0][:-1].std() > 0.0


@every_preset
@pytest.mark.parametrize("delta", [0.0, 1e-14, 1e-8, 1e-5, 1e-2])
def test_a_target_just_before_a_fold(preset, delta):
    """The unit circle takes the value 1 - delta twice, within one step."""
    for a in np.random.default_rng(3).uniform(0.1, 1.2, 8):
        homotopy = from_functions(
            lambda y, lam: np.stack([y[0] ** 2 + lam**2 - 1.0]), start=([-np.cos(a)], np.sin(a)), target=1.0 - delta
        )
        path = trace(homotopy, preset=preset, budget=Budget(steps=60))
        assert path.status is Status.REACHED_TARGET
        assert path.endpoint.y[0] == pytest.approx(-np.sqrt(delta * (2.0 - delta)), abs=2e-7)


def test_a_start_that_falls_back_is_refused():
    """An event is one of its own homotopy: with another, a line that nothing crosses, only that is found."""
    homotopy = pitchfork(-1.0)
    (event,) = branch_points(trace(homotopy, direction=-1, events=[TargetValue(0.5, component=0)]))
    for u, _ in switch_branch(homotopy, event, 0.1):
        assert abs(u[0]) < 1e-12
        assert abs(u[1]) > 0.01
    with pytest.raises(ArithmeticError):
        switch_branch(from_functions(lambda y, lam: y - lam, start=([0.0], 0.0)), event, 0.1)


def test_an_event_of_a_file_is_switched_at_too(tmp_path):
    homotopy = pitchfork(-1.0)
    path = trace(homotopy, direction=-1, events=[TargetValue(0.5, component=0)], archive=tmp_path / "path.h5")
    with open_archive(tmp_path / "path.h5") as archive:
        (stored,) = branch_points(archive[0])
    for one, other in zip(switch_branch(homotopy, stored), switch_branch(homotopy, *branch_points(path))):
        assert min(abs(one[0] - other[0]).max(), abs(one[0] - [0.0, -other[0][1]]).max()) < 0.1
        assert abs(one[0][0]) < 1e-12


def test_where_the_derivative_vanishes_altogether_there_is_no_simple_branch_point():
    """Nothing is found, and no library warns."""
    homotopy = from_functions(
        lambda y, lam: y**2 * lam, lambda y, lam: (np.diag(2.0 * y * lam), y**2), start=(np.zeros(2), 0.0)
    )
    evaluator, u = Evaluator(homotopy, Counts()), np.zeros(3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rows = row_sizes(evaluator, np.ones(3), (u,))
        assert branch_point_near(evaluator, u, np.array([0.0, 0.0, 1.0]), np.ones(3), rows) is None


@pytest.mark.parametrize("preset", [continuation.DEFAULT, continuation.CONSERVATIVE], ids=lambda preset: preset.name)
@pytest.mark.parametrize("family", ["transversal", "pitchfork", "arm", "transcritical"])
def test_random_crossings_in_random_units(family, preset):
    rng = np.random.default_rng(21)
    for _ in range(4):
        problem = campaign.FAMILIES[family](rng, int(rng.integers(1, 9)), float(rng.choice([0.0, 6.0])))
        assert campaign.judged(problem, family == "arm", preset)[0] == ""


def test_from_very_near_the_first_increments_need_not_halve():
    """Newton's method stopped 3e-8 from the crossing, at which its next increment would have been round-off."""
    *_, problem = campaign.drawn("transversal", 263, 5005)
    wrong, error, _ = campaign.judged(problem, False, continuation.SERIES)
    assert wrong == ""
    assert error < 1e-9
