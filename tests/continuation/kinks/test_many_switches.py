"""Many switches that vanish together: by all their pieces up to ten, by pivots beyond, honestly where neither tells."""

import attrs
import numpy as np
import pytest

from continuation import Status, solve_at
from problems.bifurcation import Bratu1D
from problems.nonlinear import bratu_under_obstacle

from ...util import path_of
from .util import Joined


def together(count, slope):
    """slope(signs) y = lam, from (-1, -slope(+1 ...)), and `count` switches that are multiples of y."""
    return Joined(
        lambda *signs: lambda y, lam: slope(np.array(signs)) * y - lam,
        lambda y, lam: np.multiply.outer(np.arange(1.0, count + 1.0), y[0]),
        (-1.0, -slope(-np.ones(count))),
        slope(np.ones(count)),
        lambda *signs: lambda y, lam: (np.array([[slope(np.array(signs))]]), -np.ones(1)),
    )


WEIGHTS = np.linspace(0.1, 1.0, 10)


@pytest.mark.parametrize(
    "many",
    [
        together(10, lambda signs: 10.0 + WEIGHTS @ signs),
        together(12, lambda signs: 24.0 + signs.sum()),
        together(30, lambda signs: 60.0 + signs.sum()),
    ],
    ids=["all pieces", "pivots", "many pivots"],
)
def test_switches_that_vanish_together_are_passed(many):
    path = path_of(many)
    assert [(kink.switches, len(kink.rays)) for kink in path.kinks] == [(tuple(range(many.count)), 2)]
    assert abs(path.endpoint.y[0] - 1.0) < 1e-14


def test_too_many_switches_end_the_path_honestly():
    path = path_of(together(12, lambda signs: 20.0 + abs(signs.sum())), status=Status.UNRESOLVED_KINK)
    assert "Their number is 12" in path.message
    assert "do not add up" in path.message


# All points are touched at once; or every other one, and the others go on.
@pytest.mark.parametrize("n", [9, 25])
@pytest.mark.parametrize("every", [1, 2])
def test_an_obstacle_that_is_touched_everywhere_at_once(n, every):
    u = solve_at(Bratu1D(n), 2.0)
    upper = np.where(np.arange(1, n + 1) % every, np.inf, u)
    lid = attrs.evolve(bratu_under_obstacle(n, target=3.0), upper=upper)
    path = path_of(lid)
    assert [kink.switches for kink in path.kinks] == [tuple(range(n // every))]
    assert abs(path.kinks[0].lam - 2.0) < 1e-11
    np.testing.assert_array_equal(lid.x(path.endpoint.y)[upper == u], u[upper == u])
    assert np.abs(lid.residual(path.endpoint.y, path.endpoint.lam)).max() < 1e-15
