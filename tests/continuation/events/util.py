"""Curves that cross at known places, as one homotopy, and what is found there."""

import numpy as np

from continuation import Kind, from_functions


def branch_points(path):
    return [event for event in path.events if event.kind == Kind.BRANCH_POINT]


def places(path):
    return [event.lam for event in branch_points(path)]


def two_graphs(f, g, begin, target=2.0, apart=0.0):
    """(y - f)(y - g) = apart, from the point of y = f at the parameter `begin`."""
    return from_functions(lambda y, lam: (y - f(lam)) * (y - g(lam)) - apart, start=([f(begin)], begin), target=target)


def pitchfork(at=0.0, start=(0.0, -1.0), target=1.0):
    """y (lam - at - y^2) = 0: at (0, at) the arm crosses the trunk y = 0, and its parameter turns."""
    return from_functions(
        lambda y, lam: (lam - at) * y - y**3,
        lambda y, lam: (np.diag(lam - at - 3.0 * y**2), y.copy()),
        start=([start[0]], start[1]),
        target=target,
    )
