"""Many switches that vanish together: by all their pieces up to ten, by pivots beyond, honestly where neither tells."""

import attrs
import numpy as np
import pytest

from continuation import Status, solve_at, trace
from problems.bifurcation import Bratu1D
from problems.nonlinear import bratu_under_obstacle

from .test_kinks import Joined


@pytest.mark.parametrize("count", [12, 30])
def test_switches_that_are_too_many_for_all_their_pieces_are_passed_by_pivots(count):
    many = Joined(
        lambda *signs: lambda y, lam: y * (2.0 * count + sum(signs)) - lam,
        lambda y, lam: np.multiply.outer(np.arange(1.0, count + 1.0), y[0]),
        (-1.0, -float(count)),
        target=3.0 * count,
    )
    path = trace(many)
    assert path.status is Status.REACHED_TARGET
    assert [(kink.switches, len(kink.rays)) for kink in path.kinks] == [(tuple(range(count)), 2)]
    assert abs(path.endpoint.y[0] - 1.0) < 1e-14


@pytest.mark.parametrize("n", [9, 25])
def test_an_obstacle_that_is_touched_everywhere_at_once(n):
    u = solve_at(Bratu1D(n), 2.0)
    lid = attrs.evolve(bratu_under_obstacle(n, target=3.0), upper=u)
    path = trace(lid)
    assert path.status is Status.REACHED_TARGET
    assert [kink.switches for kink in path.kinks] == [tuple(range(n))]
    assert abs(path.kinks[0].lam - 2.0) < 1e-11
    np.testing.assert_array_equal(lid.x(path.endpoint.y), u)
    # Every other point of it is held: the others go on.
    held = attrs.evolve(lid, upper=np.where(np.arange(n) % 2, u, np.inf))
    path = trace(held)
    assert path.status is Status.REACHED_TARGET
    assert [kink.switches for kink in path.kinks] == [tuple(range(n // 2))]
    assert np.abs(held.residual(path.endpoint.y, path.endpoint.lam)).max() < 1e-15


def test_too_many_switches_end_the_path_honestly():
    many = Joined(
        lambda *signs: lambda y, lam: y * (20.0 + abs(sum(signs))) - lam,
        lambda y, lam: np.multiply.outer(np.arange(1.0, 13.0), y[0]),
        (-1.0, -32.0),
        target=8.0,
    )
    path = trace(many)
    assert path.status is Status.UNRESOLVED_KINK
    assert "Their number is 12" in path.message
    assert "do not add up" in path.message


def test_ten_switches_that_vanish_together():
    weights = np.linspace(0.1, 1.0, 10)
    many = Joined(
        lambda *signs: lambda y, lam: 10.0 * y + np.array([weights @ signs]) * y - lam,
        lambda y, lam: np.multiply.outer(np.arange(1.0, 11.0), y[0]),
        (-1.0, -(10.0 - weights.sum())),
        1.0,
        lambda *signs: lambda y, lam: (np.array([[10.0 + weights @ signs]]), -np.ones(1)),
    )
    path = trace(many)
    assert path.status is Status.REACHED_TARGET
    assert [kink.switches for kink in path.kinks] == [tuple(range(10))]
    assert abs(path.endpoint.y[0] - 1.0 / (10.0 + weights.sum())) < 1e-15
