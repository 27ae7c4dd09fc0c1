"""Vector fields and simulations that several tests use."""

import numpy as np
from scipy.integrate import solve_ivp

from problems.orbits.models import normal_form


def bent(z, p):
    """The normal form after the change of variables v = y - x^3."""
    x, v = z
    x_dot, y_dot = normal_form((x, v + x**3), p)
    return np.stack([x_dot, y_dot - 3.0 * x * x * x_dot])


def by_hand(z, p):
    """The normal form's derivative."""
    x, y = z
    r = x * x + y * y
    a, slope = p + r - r * r, 1.0 - 2.0 * r
    by_x = np.array(
        [[a + 2 * x * x * slope, 2 * x * y * slope - 1.0], [2 * x * y * slope + 1.0, a + 2 * y * y * slope]]
    )
    return by_x, np.stack([x, y])


def one_by_one(z, p):
    """The normal form for one state at a time: `if` sees no columns."""
    if z[0] > 1e9:
        return z
    return normal_form(z, p)


def of_sizes(z, p):
    """The normal form with sizes: no analytic function, so that complex steps are wrong."""
    x, y = z
    r = np.abs(x) ** 2 + np.abs(y) ** 2
    a = p + r - r * r
    return np.stack([a * x - y, a * y + x])


def two_circles(z, p):
    """A circle of period 2 pi, stable, and across it a focus that loses its stability at p = 0: a torus."""
    x, y, u, v = z
    a, b = 1.0 - x * x - y * y, p - u * u - v * v
    return np.stack([a * x - y, a * y + x, b * u - 0.3 * v, b * v + 0.3 * u])


def simulated(f, p, x0, settling=100.0, time=60.0):
    """Times and states of a simulation that has settled."""
    options = {"rtol": 1e-8, "atol": 1e-8, "method": "DOP853"}
    begin = solve_ivp(lambda t, x: f(x, p), (0.0, settling), x0, **options).y[:, -1]
    found = solve_ivp(lambda t, x: f(x, p), (0.0, time), begin, max_step=0.2, **options)
    return found.t, found.y.T
