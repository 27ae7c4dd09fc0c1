"""Curves in families of every structure; those in closed form are in `test_curves.py` and `test_units.py`."""

import numpy as np
import pytest

import continuation
from continuation import Curve, Family, Kind, TargetValue

from ...util import path_of
from .util import Diffusing, GelfandBanded, first_fold, named


@pytest.mark.parametrize("kind", ["banded", "sparse"])
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


@pytest.mark.parametrize(("n", "accuracy"), [(10, 1e-10), (300, 1e-9)])
def test_hopf_points_of_a_sparse_family(n, accuracy):
    homotopy = Diffusing(n)
    curve = Curve(Family(homotopy, "turn"), Kind.HOPF, (np.zeros(2 * n), homotopy.rate(1) + 0.01))
    path = path_of(curve, box={"lam": (None, 4.0)}, status=continuation.Status.STOPPED_AT_EVENT)
    np.testing.assert_allclose(path.y[:, -2], homotopy.rate(1), rtol=accuracy)
    np.testing.assert_allclose(path.y[:, -1], path.lam, rtol=accuracy)
