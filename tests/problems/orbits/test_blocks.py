"""The equations as matrices, and their condensed form."""

import numpy as np

from problems.orbits import PeriodicOrbit
from problems.orbits.grid import Grid
from problems.orbits.multipliers import Multipliers


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
