"""The equations as matrices, and their condensed form."""

import numpy as np
import pytest

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
def test_the_derivative_as_a_matrix_and_condensed(f, n, intervals, degree):
    for seed in range(3):
        given = orbit(f, n, intervals, degree, seed)
        y, p = given.start()
        generator = np.random.default_rng(seed)
        H_y, H_p = given.jacobian(y, p)
        full = np.column_stack([H_y.toarray(), H_p])
        v, h = generator.standard_normal(y.size + 1), 1e-6
        ahead, behind = (given.residual(y + k * h * v[:-1], p + k * h * v[-1]) for k in (1.0, -1.0))
        assert np.allclose(full @ v, (ahead - behind) / (2.0 * h), rtol=1e-5, atol=1e-6 * np.abs(full @ v).max())
        # What follows from ends that A and B allow satisfies all blocks but the last, where x_N is not x_0.
        condensed = given.equations.here(y, p)._condensed
        x = generator.standard_normal(n)
        ends = np.stack([x, np.linalg.solve(condensed.B, -condensed.A @ x)])
        X = condensed.all_from(ends) * given.scale
        blocks = full[: -degree * n - intervals, : X.size] @ X.ravel()
        size = np.abs(full[: -degree * n - intervals, : X.size]) @ np.abs(X.ravel())
        assert (np.abs(blocks) <= 1e-9 * size).all()


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
