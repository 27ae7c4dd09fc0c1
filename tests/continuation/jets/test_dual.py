"""Derivatives along a vector by dual numbers: over numbers, jets and intervals, for every function that they know."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation import jets
from continuation.intervals import Interval
from continuation.jets import derivative_along
from continuation.numbers.series import ELEMENTARY

from ..util import assigned

X, V = np.array([0.3, 0.7, 0.45, 0.6]), np.array([1.0, -0.4, 0.25, 2.0])
MATRIX = np.arange(16.0).reshape(4, 4) - 5.0

FUNCTIONS = {
    **{f.__name__: f for f in ELEMENTARY if f is not np.arccosh},
    "arccosh": lambda y: np.arccosh(y + 1.0),
    "arithmetic": lambda y: (2.0 - y) * y / (1.0 + y * y) - y**3 + y**0.5 + y**-2 + 2.0**y - -y,
    "a power of each": lambda y: y ** np.array([0.0, 1.0, 2.0, 3.0]),
    "a variable power": lambda y: y[:2] ** y[2:],
    "two": lambda y: np.hypot(y, 2.0) + np.arctan2(y, y + 1.0) + np.maximum(y, 0.5) - np.minimum(y[::-1], y),
    "products": lambda y: np.stack([y @ y, np.dot(MATRIX, y)[1], np.vdot(y, 2.0 * y)]),
    "matrices": lambda y: MATRIX @ y + y @ MATRIX,
    "einsum": lambda y: np.einsum("i,j->ij", y, y).sum(axis=0) + np.einsum("i->", y) + np.outer(y, y)[1],
    "sparse": lambda y: sp.csr_array(MATRIX) @ y,
    "sums": lambda y: y + y.mean() + np.prod(y) + np.linalg.norm(y) + np.sum(np.diff(y)),
    "assembly": lambda y: np.concatenate([y[:1], np.append(y[1:3], y[3])]) + np.hstack([y[2:], [1.0, 2.0]]),
    "assignment": assigned,
    "a list of entries": lambda y: np.array([y[0] * y[1], np.sin(y[2]), 1.0, y[3]]) * 2.0,
    "shape": lambda y: np.roll(y, 1).reshape(2, 2).T.ravel() + np.pad(y[1:3], 1) + np.where(X > 0.5, y, -y),
    "others": lambda y: np.clip(y, 0.4, 0.65) + np.split(y, 2)[0][0] + np.take(y, [3, 3, 0, 1]),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_slope_is_that_of_jets_and_intervals_hold_it(name):
    function = FUNCTIONS[name]
    wanted, slope = jets.taylor(function, X, 1, V)
    value, found = derivative_along(function, X, V)
    np.testing.assert_allclose(value, wanted, rtol=1e-14)
    np.testing.assert_allclose(np.broadcast_to(found, slope.shape), slope, rtol=1e-12, atol=1e-13)
    value, found = derivative_along(function, Interval(X), Interval(V))
    for interval, exact in ((value, wanted), (found, slope)):
        slack = 1e-14 * (1.0 + np.abs(exact))
        assert (interval.lo <= exact + slack).all()
        assert (exact - slack <= interval.hi).all()
        assert (interval.hi - interval.lo <= 1e-12 * (1.0 + np.abs(exact))).all()


@pytest.mark.parametrize(
    ("function", "name"),
    [
        (np.sort, "numpy.sort"),
        (np.floor, "numpy.floor"),
        (np.add.reduce, "numpy.add.reduce"),
        (lambda y: np.where(y, y, y), "numpy.where"),
    ],
)
def test_what_is_not_known_is_named(function, name):
    with pytest.raises(TypeError, match=name):
        derivative_along(function, X, V)
