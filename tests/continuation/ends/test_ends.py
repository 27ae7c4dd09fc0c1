"""Which end a path gets: at the target, at a fold or an inflection there, far away, closed, turned back."""

import math

import numpy as np
import pytest

from continuation import Budget, Kind, Status, from_functions, trace
from problems.bifurcation import Circle

from ...util import every_preset, path_of
from ..util import scalar

EPS = np.finfo(float).eps


def power(p, start=(1.0, 1.0), target=0.0):
    """y^p = lam."""
    return scalar(lambda y, lam: y**p - lam, lambda y, lam: (p * y ** (p - 1), -1.0), start=start, target=target)


@every_preset
@pytest.mark.parametrize(
    ("homotopy", "y", "within"),
    [
        (power(1, (0.0, 0.0)), 0.0, 1e-12),
        *((power(2, start), 0.0, 1e-7) for start in ((1.0, 1.0), (3.0, 9.0), (-1.0, 1.0))),
        *((power(2, target=d), math.sqrt(d), 1e-6 * math.sqrt(d)) for d in (1e-2, 1e-5, 1e-8, 1e-14)),
        # Of multiplicity p: an error of round-off in lam is one of its p-th root in y.
        *((power(p), 0.0, 10.0 * EPS ** (1.0 / p)) for p in (3, 5)),
        (power(3, target=-1.0), -1.0, 1e-9),
        # y_k = k lam^2, far away.
        *(
            (from_functions(lambda y, lam, k=k: y - lam**2 * k, start=(0.0 * k, 0.0), target=1e5), 1e10, 1.0)
            for k in (np.array([1.0]), np.array([1.0, 2.0, 3.0]))
        ),
        # A start near the path is brought on it; one unknown may be a number; and overflow makes no noise.
        (scalar(lambda y, lam: y * y - 1.0 - lam, lambda y, lam: (2.0 * y, -1.0), (1.2, 0.0)), math.sqrt(2.0), 1e-10),
        (from_functions(lambda y, lam: y**3 + y - lam, start=(0.0, 0.0), target=2.0), 1.0, 1e-10),
        (from_functions(lambda y, lam: np.sinh(y) - lam, start=([0.0], 0.0), target=1e6), math.asinh(1e6), 1e-5),
    ],
    ids=[
        "start on it", "fold", "fold from afar", "fold from below", "fold 1e-2 behind", "fold 1e-5 behind",
        "fold 1e-8 behind", "fold 1e-14 behind", "inflection", "flat inflection", "behind an inflection", "growth",
        "growth of three", "start beside the path", "a number", "overflow",
    ],
)  # fmt: skip
def test_a_target_is_reached_exactly(homotopy, y, within, preset):
    path = path_of(homotopy, preset=preset)
    assert path.endpoint.lam == homotopy.target
    assert abs(path.endpoint.y[0] - y) <= within
    assert path.steps[0].residual_norm <= 1e-8
    # A fold on the target itself may be seen or not.
    assert path.events == (path.turning_points if within == 1e-7 else [])


def test_a_start_in_a_fold_is_regular():
    path = trace(power(2, (0.0, 0.0), 1.0))
    assert (path.status, abs(path.endpoint.y[0])) == (Status.REACHED_TARGET, pytest.approx(1.0, abs=1e-10))


def test_a_fold_just_before_the_target_is_no_end():
    path = path_of(power(2, target=-1e-3), budget=Budget(steps=50), status=Status.BUDGET_EXHAUSTED)
    # It turns in the fold, a thousandth before the target, and goes on on the other side: the parameter never stalls.
    (fold,) = path.turning_points
    np.testing.assert_allclose(fold.u, 0.0, rtol=0, atol=1e-12)
    assert path.lam.min() >= 0.0
    assert path.endpoint.y[0] < -1.0


@pytest.mark.parametrize(
    ("residual", "slope", "start", "target"),
    [
        (lambda y, lam: lam * y - 1.0, lambda y, lam: (lam, y), (1.0, 1.0), 0.0),
        (
            lambda y, lam: y * np.cos(lam) - np.sin(lam),
            lambda y, lam: (np.cos(lam), -y * np.sin(lam) - np.cos(lam)), (0.0, 0.0), 2.0,
        ),
        (lambda y, lam: np.arctan(y) - lam, lambda y, lam: (1.0 / (1.0 + y * y), -1.0), (0.0, 0.0), 2.0),
    ],
    ids=["1/lam", "tan", "arctan"],
)  # fmt: skip
def test_divergence(residual, slope, start, target):
    path = path_of(scalar(residual, slope, start, target), status=Status.DIVERGED)
    assert abs(path.endpoint.y[0]) > 1e3
    assert len(path) < 200


# Near a turning point the path says little of its extents: some of these went round and round.
@pytest.mark.parametrize("angle", [0.3, 2.0, 4.0, *(0.5 * math.pi + np.array([-0.02, -0.007, 0.003, 0.01]))])
def test_a_closed_curve_that_starts_anywhere(angle):
    start = (math.cos(angle), math.sin(angle))
    path = trace(scalar(Circle().residual, lambda y, lam: (2.0 * y, 2.0 * lam), start=start, target=None))
    assert (path.status, len(path.turning_points)) == (Status.CLOSED, 2)
    np.testing.assert_allclose(path.endpoint.u, start, rtol=0, atol=1e-9)


def test_a_figure_of_eight_closes_after_both_loops():
    # Gerono's lemniscate lam^4 = lam^2 - y^2 crosses itself in the origin: not closed before the second passage.
    homotopy = scalar(
        lambda y, lam: lam**4 - lam**2 + y * y, lambda y, lam: (2.0 * y, 4.0 * lam**3 - 2.0 * lam), (0.0, 1.0), None
    )
    path = path_of(homotopy, status=Status.CLOSED)
    np.testing.assert_allclose(path.endpoint.u, (0.0, 1.0), rtol=0, atol=1e-9)
    assert [event.kind for event in path.events].count(Kind.BRANCH_POINT) == 2
    assert path.lam.min() < -0.9


class Inside(Circle):
    """The circle as an interior path: |y| <= 2 always holds, the target is never reached."""

    target = 2.0

    def max_step(self, u, v):
        return np.inf if v[0] == 0.0 else float((2.0 - np.sign(v[0]) * u[0]) / abs(v[0]))


def test_an_interior_path_that_comes_back_to_its_start_value():
    path = path_of(Inside(), status=Status.TURNED_BACK)
    np.testing.assert_allclose(path.endpoint.u, (-1.0, 0.0), rtol=0, atol=1e-9)
