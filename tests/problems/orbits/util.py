"""Vector fields with known orbits, and simulations of them."""

import numpy as np
from scipy.integrate import solve_ivp


def normal_form(z, p, second=1.0):
    """r' = r (p + second r^2 - r^4), theta' = 1: orbits of period 2 pi, a fold of cycles at p = -second^2 / 4."""
    x, y = z
    r = x * x + y * y
    a = p + second * r - r * r
    return np.stack([a * x - y, a * y + x])


def bent(z, p):
    """The normal form after the change of variables v = y - x^3."""
    x, v = z
    x_dot, y_dot = normal_form((x, v + x**3), p)
    return np.stack([x_dot, y_dot - 3.0 * x * x * x_dot])


def normal_form_by_hand(z, p):
    """The normal form's derivative."""
    x, y = z
    r = x * x + y * y
    a, slope = p + r - r * r, 1.0 - 2.0 * r
    by_x = np.array(
        [[a + 2 * x * x * slope, 2 * x * y * slope - 1.0], [2 * x * y * slope + 1.0, a + 2 * y * y * slope]]
    )
    return by_x, np.stack([x, y])


def one_by_one(z, p):
    """The normal form for those who call with one state: `if` sees no columns."""
    if z[0] > 1e9:
        return z
    return normal_form(z, p)


def rigid(z, p):
    """A field that complex numbers cannot tell: the size of a complex number is no analytic function."""
    x, y = z
    r = np.abs(x) ** 2 + np.abs(y) ** 2
    a = p + r - r * r
    return np.stack([a * x - y, a * y + x])


def van_der_pol(z, mu):
    x, y = z
    return np.stack([y, mu * (1.0 - x * x) * y - x])


def brusselator(z, b):
    x, y = z
    return np.stack([1.0 - (b + 1.0) * x + x * x * y, b * x - x * x * y])


def roessler(z, c, a=0.2):
    x, y, w = z
    return np.stack([-y - w, x + a * y, 0.2 + w * (x - c)])


def lorenz(z, r):
    x, y, w = z
    return np.stack([10.0 * (y - x), r * x - y - x * w, x * y - 8.0 / 3.0 * w])


def simulated(f, p, x0, settling=100.0, time=60.0):
    """Times and states of a simulation that has settled."""
    options = {"rtol": 1e-8, "atol": 1e-8, "method": "DOP853"}
    begin = solve_ivp(lambda t, x: f(x, p), (0.0, settling), x0, **options).y[:, -1]
    found = solve_ivp(lambda t, x: f(x, p), (0.0, time), begin, max_step=0.2, **options)
    return found.t, found.y.T
