"""Two crossings near each other, or in one step: both are seen, and the path stays on its branch."""

import numpy as np
import pytest

import continuation
from continuation import Status, from_functions, trace

from ...util import every_preset
from .test_crossings import branch_points, campaign


@pytest.mark.parametrize(
    ("family", "seed", "k", "preset"),
    [
        ("transversal", 777, 480, continuation.DEFAULT),
        ("transversal", 777, 641, continuation.CONSERVATIVE),
        ("apart", 888, 443, continuation.DEFAULT),
        ("apart", 888, 830, continuation.FAST),
        ("apart", 888, 151, continuation.SERIES),
    ],
    ids=lambda value: getattr(value, "name", str(value)),
)
def test_between_two_crossings_graphs_are_nearer_than_predictions(family, seed, k, preset):
    """Each of these left its graph at the second crossing, or (the last) stopped in the first one."""
    *_, problem = campaign.drawn(family, k + 1, seed)
    assert len(problem.crossings) == 2
    assert campaign.judged(problem, False, preset)[0] == ""


@pytest.mark.parametrize(
    ("family", "seed", "k", "preset"),
    [
        ("apart", 912, 168, continuation.DEFAULT),
        ("pairs", 4004, 163, continuation.DEFAULT),
        ("pairs", 4004, 163, continuation.CONSERVATIVE),
    ],
    ids=lambda value: getattr(value, "name", str(value)),
)
def test_two_crossings_within_one_step_that_nothing_announced(family, seed, k, preset):
    """Half way over the first H' is as it was or farther from singular; the other was out of sight of one vector."""
    *_, problem = campaign.drawn(family, k + 1, seed)
    assert campaign.judged(problem, False, preset)[0] == ""


@every_preset
@pytest.mark.parametrize(("first", "gap"), [(-0.37, 0.034), (0.61, 0.034), (0.26, 0.01), (0.965, 0.0094)])
def test_a_trunk_crossed_twice_within_a_step(first, gap, preset):
    """y (y - (t - first) (t - first - gap)) = 0 along y = 0: the determinant's sign is the same on both sides."""

    def apart(t):
        return (t - first) * (t - first - gap)

    path = trace(
        from_functions(
            lambda y, t: np.stack([y[0] * (y[0] - apart(t))]),
            lambda y, t: (np.array([[2.0 * y[0] - apart(t)]]), np.array([-y[0] * (2.0 * (t - first) - gap)])),
            start=([0.0], -2.0),
        ),
        target=2.0,
        preset=preset,
    )
    assert path.status is Status.REACHED_TARGET
    assert [event.lam for event in branch_points(path)] == pytest.approx([first, first + gap], abs=1e-11)


def test_a_graph_is_not_left_where_a_prediction_lands_on_the_other():
    """Behind the crossing at -0.103 the two are nearer than a prediction is to either, which the corrector likes."""
    own, other = np.array([1.8268, -3.0783, 0.9581]), np.array([0.00696, 0.13183, 0.03856])

    def graph(c, t):
        return c[0] * t + c[1] * t**2 * 0.5 + c[2] * (np.sin(2.0 * t) - 2.0 * t) * 0.3

    def slope(c, t):
        return c[0] + c[1] * t + c[2] * (2.0 * np.cos(2.0 * t) - 2.0) * 0.3

    def off(y, t):
        return y[0] - graph(own, t), y[0] - graph(own + other, t)

    path = trace(
        from_functions(
            lambda y, t: np.stack([np.prod(off(y, t))]),
            lambda y, t: (
                np.array([[sum(off(y, t))]]),
                np.array([-slope(own, t) * off(y, t)[1] - slope(own + other, t) * off(y, t)[0]]),
            ),
            start=([graph(own, -1.9317)], -1.9317),
        ),
        target=2.0,
        preset=continuation.DEFAULT,
    )
    assert [event.lam for event in branch_points(path)] == pytest.approx([-0.103108114843, 0.0], abs=1e-11)
    assert path.endpoint.y[0] == pytest.approx(graph(own, 2.0))


@pytest.mark.parametrize(
    ("c", "pair", "last"), [(2.5, 0.02, 0.8), (0.25, 0.02, 0.8), (1.43, 0.05, 1.1), (2.93, 0.01, 0.93)]
)
def test_a_pair_of_crossings_in_a_long_step_of_a_series(c, pair, last):
    """y = f(t) and y = f(t) + c t (t - pair) (t - last): the first two were passed between two looks, or all as one."""

    def apart(t):
        return c * t * (t - pair) * (t - last)

    def residual(y, t):
        own = y[0] + 0.8 * t + 0.1 * np.sin(2.0 * t)
        return np.stack([own * (own - apart(t))])

    path = trace(
        from_functions(residual, start=([1.6 + 0.1 * np.sin(4.0)], -2.0)), target=2.0, preset=continuation.SERIES
    )
    assert [event.lam for event in branch_points(path)] == pytest.approx([0.0, pair, last], abs=1e-11)
    assert path.endpoint.y[0] == pytest.approx(-1.6 - 0.1 * np.sin(4.0))
