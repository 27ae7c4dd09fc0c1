"""Curves of folds by differences, in banded and sparse families, and of the aircraft; others are in `test_units.py`."""

import numpy as np
import pytest

import continuation
from continuation import Curve, Family, TargetValue
from problems.bifurcation import Cusp

from .util import GelfandBanded, first_fold, named


def test_the_whole_curve_by_differences_since_a_validator_wants_floats():
    path = continuation.trace_both(
        Curve(Family(Cusp(1.0), "splitting"), first_fold(Cusp(1.0))),
        box={"lam": (-4.0, 4.0), "y": (-16.0, 16.0)},
        tolerance=1e-12,
    )
    _, a, b = path.u.T
    assert np.abs(27.0 * a**2 - 4.0 * b**3).max() <= 1e-10
    (cusp,) = named(path, "cusp")
    assert np.abs(cusp.u).max() <= 1e-10
    assert {np.sign(u) for u in a} >= {-1.0, 1.0}


@pytest.mark.parametrize("kind", ["banded", "sparse", "symmetric"])
def test_structures_give_one_curve(kind):
    ours, dense = (
        continuation.trace(Curve(Family(member, "eps"), first_fold(member)), box={"y": (None, 7.0)})
        for member in (GelfandBanded(kind=kind), GelfandBanded(kind="dense"))
    )
    assert len(ours) == len(dense)
    np.testing.assert_allclose(ours.u, dense.u, rtol=1e-5, atol=1e-9)
    (cusp,), (other,) = (named(path, "cusp") for path in (ours, dense))
    assert abs(cusp.lam - other.lam) <= 1e-11


def test_operators_have_curves_of_values_alone():
    member = GelfandBanded(kind="operator")
    curve = Curve(Family(member, "eps"), TargetValue(0.5, 7), (np.full(16, 0.4), 0.8))
    path = continuation.trace(curve, box={"lam": (None, 0.4)}, tolerance=1e-10)
    assert np.abs(path.y[:, 7] - 0.5).max() <= 1e-12
    assert max(np.abs(GelfandBanded(u[-1]).residual(u[:-2], u[-2])).max() for u in path.u) <= 1e-10
    with pytest.raises(ArithmeticError, match="a matrix is needed here, and the Jacobian is an operator"):
        continuation.trace(Curve(Family(member, "eps"), first_fold(member)))
