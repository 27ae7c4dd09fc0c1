"""The condensed factorisation against a dense one."""

import numpy as np
import pytest

from continuation.linear import SingularError
from problems.orbits import PeriodicOrbit
from problems.orbits.grid import Grid
from problems.orbits.models import lorenz, normal_form
from problems.orbits.multipliers import Multipliers

from .util import two_circles


def orbit(f, n, intervals, degree, seed):
    generator = np.random.default_rng(seed)
    mesh = np.concatenate([[0.0], np.cumsum(generator.uniform(0.5, 2.0, intervals))])
    return PeriodicOrbit(
        f, generator.standard_normal((intervals * degree, n)), 2.0, 0.3, mesh / mesh[-1], degree,
        scale=10.0 ** generator.uniform(-3.0, 3.0, n),
    )  # fmt: skip


@pytest.mark.parametrize(("f", "n"), [(normal_form, 2), (lorenz, 3), (two_circles, 4)])
@pytest.mark.parametrize(("intervals", "degree"), [(2, 2), (3, 4), (5, 3), (8, 2), (11, 5)])
def test_solves_and_sign_are_those_of_the_matrix(f, n, intervals, degree):
    for seed in range(3):
        given = orbit(f, n, intervals, degree, seed)
        y, p = given.start()
        generator = np.random.default_rng(seed)
        border, r = generator.standard_normal(y.size + 1), generator.standard_normal(y.size)
        H_y, H_p = given.jacobian(y, p)
        full = np.vstack([np.column_stack([H_y.toarray(), H_p]), border])
        system = given.bordered(y, p, border)
        z = system.solve(r, 0.7)
        left = np.abs(full @ z - np.append(r, 0.7))
        assert (left <= 1e-9 * (np.abs(full) @ np.abs(z) + 1.0)).all()
        assert system.sign == np.linalg.slogdet(full)[0]
        v = generator.standard_normal(y.size + 1)
        applied, terms = given.differential(y, p, v), np.abs(full[:-1]) @ np.abs(v)
        assert (np.abs(applied - full[:-1] @ v) <= 1e-13 * terms).all()


def test_what_is_singular_is_said_to_be():
    given = orbit(normal_form, 2, 4, 3, 0)
    y, p = given.start()
    with pytest.raises(SingularError):
        given.bordered(y, p, np.zeros(y.size + 1))


def test_small_multipliers_keep_their_digits_beside_large_ones():
    """x' = x, y' = -y and a circle beside them: exp(2 pi), exp(-2 pi) and those of the circle, 1 and exp(-4 pi)."""

    def f(z, p):
        x, y, u, v = z
        a = 1.0 - u * u - v * v
        return np.stack([x, -y, a * u - v, a * v + u])

    t = 2.0 * np.pi * Grid(np.linspace(0.0, 1.0, 21), 4).nodes
    states = np.stack([0.0 * t, 0.0 * t, np.cos(t), np.sin(t)], axis=1)
    circle = PeriodicOrbit(f, states, 2.0 * np.pi, 0.0, 20, 4, scale=np.ones(4))
    found = np.sort(circle.multipliers(*circle.start()).values.real)
    assert np.allclose(found, np.exp(2.0 * np.pi * np.array([-2.0, -1.0, 0.0, 1.0])), rtol=1e-6)


def test_no_period_doubling_is_seen_where_one_multiplier_swallows_the_others():
    """Near a homoclinic orbit one is 1e20 and more; of the rest, round-off of that, one may look like 1 by chance."""
    assert Multipliers(-np.diag([1.0, 3.0, -2.0]), np.eye(3)).doubling < 0.0
    swallowed = Multipliers(-np.diag([1.001, 1e20, -2.0]), np.eye(3))
    assert (swallowed.doubling, swallowed.torus) == (1.0, -1.0)
