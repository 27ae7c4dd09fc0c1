"""Homotopies of one equation, and a function that assigns."""

import numpy as np

from continuation import from_functions


def scalar(residual, slope=None, start=(0.0, 0.0), target=1.0):
    """One equation, with (H_y, H_lam) by `slope`, or by the library."""
    jacobian = None
    if slope is not None:

        def jacobian(y, lam):
            by_y, by_lam = slope(y[0], lam)
            return np.array([[by_y]]), np.array([by_lam])

    return from_functions(residual, jacobian, start=([start[0]], start[1]), target=target)


def assigned(y):
    """Into an array like another."""
    out = np.zeros_like(y)
    out[0] = y[1] * y[1]
    out[1:] = y[:-1] ** 2
    out[2] += 3.0 * y[3]
    out[np.array([0, 2])] -= 1.0
    return out
