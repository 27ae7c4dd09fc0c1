"""Which end a path gets: at the target, at a fold or an inflection there, far away, closed, turned back."""

import math

import numpy as np
import pytest

from continuation import Budget, Kind, Status, TargetValue, from_functions, trace
from problems.bifurcation import Circle, Cusp

from ..util import scalar


def test_a_start_on_the_target_is_the_end():
    path = trace(scalar(lambda y, lam: y - lam, lambda y, lam: (1.0, -1.0), target=0.0))
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.u == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("start", [(1.0, 1.0), (3.0, 9.0), (-1.0, 1.0)])
def test_a_fold_at_the_target(start):
    path = trace(scalar(lambda y, lam: y * y - lam, lambda y, lam: (2.0 * y, -1.0), start=start, target=0.0))
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(path.endpoint.u, 0.0, rtol=0, atol=1e-7)


def test_a_fold_just_before_the_target_is_no_end():
    homotopy = scalar(lambda y, lam: y * y - lam, lambda y, lam: (2.0 * y, -1.0), start=(1.0, 1.0), target=-1e-3)
    path = trace(homotopy, budget=Budget(steps=50))
    # It turns in the fold, a thousandth before the target, and goes on on the other side: the parameter never stalls.
    assert path.status is Status.BUDGET_EXHAUSTED
    (fold,) = path.turning_points
    np.testing.assert_allclose(fold.u, 0.0, rtol=0, atol=1e-12)
    assert path.lam.min() >= 0.0
    assert path.endpoint.y[0] < -1.0


@pytest.mark.parametrize("target", [1e-3, 1e-6, 1e-10])
def test_a_fold_just_behind_the_target(target):
    homotopy = scalar(lambda y, lam: y * y - lam, lambda y, lam: (2.0 * y, -1.0), start=(1.0, 1.0), target=target)
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.lam == target
    assert path.endpoint.y[0] == pytest.approx(np.sqrt(target), rel=1e-6)


@pytest.mark.parametrize("power", [3, 5])
def test_an_inflection_at_the_target(power):
    homotopy = scalar(
        lambda y, lam: y**power - lam, lambda y, lam: (power * y ** (power - 1), -1.0), start=(1.0, 1.0), target=0.0
    )
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.lam == 0.0
    # Of multiplicity p: an error of round-off in lam is one of its p-th root in y.
    assert abs(path.endpoint.y[0]) <= 10.0 * np.finfo(float).eps ** (1.0 / power)
    assert path.turning_points == []


def test_through_an_inflection():
    homotopy = scalar(lambda y, lam: y**3 - lam, lambda y, lam: (3.0 * y * y, -1.0), start=(1.0, 1.0), target=-1.0)
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.y[0] == pytest.approx(-1.0, abs=1e-9)
    assert path.events == []


@pytest.mark.parametrize(
    "homotopy",
    [
        scalar(lambda y, lam: lam * y - 1.0, lambda y, lam: (lam, y), start=(1.0, 1.0), target=0.0),
        scalar(
            lambda y, lam: y * np.cos(lam) - np.sin(lam),
            lambda y, lam: (np.cos(lam), -y * np.sin(lam) - np.cos(lam)),
            target=2.0,
        ),
        scalar(lambda y, lam: np.arctan(y) - lam, lambda y, lam: (1.0 / (1.0 + y * y), -1.0), target=2.0),
    ],
    ids=["1/lam", "tan", "arctan"],
)
def test_divergence(homotopy):
    path = trace(homotopy)
    assert path.status is Status.DIVERGED
    assert abs(path.endpoint.y[0]) > 1e3
    assert len(path) < 200


@pytest.mark.parametrize("n", [1, 3])
def test_growth_with_the_parameter_is_not_divergence(n):
    homotopy = from_functions(lambda y, lam: y - lam**2 * np.arange(1.0, n + 1), start=(np.zeros(n), 0.0), target=1e5)
    assert trace(homotopy).status is Status.REACHED_TARGET


def test_a_closed_curve_that_starts_anywhere():
    # Near a turning point the path says little of its extents: some of these went round and round.
    for angle in (0.3, 2.0, 4.0, *(0.5 * math.pi + np.array([-0.02, -0.007, 0.003, 0.01]))):
        start = (math.cos(angle), math.sin(angle))
        path = trace(scalar(Circle().residual, lambda y, lam: (2.0 * y, 2.0 * lam), start=start, target=None))
        assert path.status is Status.CLOSED
        assert len(path.turning_points) == 2
        np.testing.assert_allclose(path.endpoint.u, start, rtol=0, atol=1e-9)


def test_a_figure_of_eight_closes_after_both_loops():
    # Gerono's lemniscate lam^4 = lam^2 - y^2 crosses itself in the origin: not closed before the second passage.
    homotopy = scalar(
        lambda y, lam: lam**4 - lam**2 + y * y,
        lambda y, lam: (2.0 * y, 4.0 * lam**3 - 2.0 * lam),
        start=(0.0, 1.0),
        target=None,
    )
    path = trace(homotopy)
    assert path.status is Status.CLOSED
    np.testing.assert_allclose(path.endpoint.u, (0.0, 1.0), rtol=0, atol=1e-9)
    crossings = [event for event in path.events if event.kind == Kind.BRANCH_POINT]
    assert len(crossings) == 2
    assert path.lam.min() < -0.9


class Inside(Circle):
    """The circle as an interior path: |y| <= 2 always holds, the target is never reached."""

    target = 2.0

    def max_step(self, u, v):
        return np.inf if v[0] == 0.0 else float((2.0 - np.sign(v[0]) * u[0]) / abs(v[0]))


def test_an_interior_path_that_comes_back_to_its_start_value():
    path = trace(Inside())
    assert path.status is Status.TURNED_BACK
    np.testing.assert_allclose(path.endpoint.u, (-1.0, 0.0), rtol=0, atol=1e-9)


def test_an_end_at_once_when_the_event_is_reached():
    path = trace(Cusp(), events=[TargetValue(-1.0, component=0)])
    assert path.endpoint.y[0] == -1.0
