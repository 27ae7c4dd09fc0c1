"""Curves of Hopf points, with their frequencies; those in closed form are in `test_units.py`."""

import numpy as np
import pytest

import continuation
from continuation import Curve, Family, Kind, Status

from .util import Diffusing, brusselator, cusp_form, named, takens_bogdanov, zero_hopf


def test_it_ends_where_its_frequency_is_zero():
    curve = Curve(takens_bogdanov, Kind.HOPF, (np.array([-1.0, 0.0]), -1.0), mu=1.0)
    path = continuation.trace(curve, direction=-1, tolerance=1e-12)
    assert path.status is Status.STOPPED_AT_EVENT
    y, _, lam, frequency, mu = path.u.T
    assert np.abs(y + mu).max() <= 1e-10
    assert np.abs(lam + mu**2).max() <= 1e-10
    assert np.abs(frequency**2 - 2.0 * mu).max() <= 1e-10
    (end,) = named(path, "Bogdanov-Takens")
    assert np.abs(end.u).max() <= 1e-10


def test_it_passes_where_the_equilibrium_turns():
    curve = Curve(zero_hopf, Kind.HOPF, (np.array([-1.0, 0.0, 0.0]), 1.0), mu=1.0)
    path = continuation.trace(curve, direction=-1, box={"lam": (-1.5, None)}, tolerance=1e-12)
    assert np.abs(path.y[:, 3] - path.lam**2).max() <= 1e-10
    assert np.abs(path.y[:, 4] - 2.0).max() <= 1e-10
    (point,) = named(path, "zero-Hopf")
    assert np.abs(point.u - [0.0, 0.0, 0.0, 0.0, 2.0, 0.0]).max() <= 1e-10


@pytest.mark.parametrize(("n", "accuracy"), [(10, 1e-10), (300, 1e-9)])
def test_sparse(n, accuracy):
    homotopy = Diffusing(n)
    curve = Curve(Family(homotopy, "turn"), Kind.HOPF, (np.zeros(2 * n), homotopy.rate(1) + 0.01))
    path = continuation.trace(curve, box={"lam": (None, 4.0)})
    assert path.success
    np.testing.assert_allclose(path.y[:, -2], homotopy.rate(1), rtol=accuracy)
    np.testing.assert_allclose(path.y[:, -1], path.lam, rtol=accuracy)


def test_no_pair_near_the_axis_is_said():
    near = r"at: expected a pair of eigenvalues of H_y near the imaginary axis, found "
    away = brusselator, Kind.HOPF, (np.array([1.0, 1.2]), 1.2)
    for curve, found in (
        (Curve(cusp_form, Kind.HOPF, (np.zeros(1), 0.0), mu=1.0), "none"),
        (Curve(*away, mu=1.0), r"-0.4\+0.917j"),
    ):
        with pytest.raises(ValueError, match=near + found):
            continuation.trace(curve)
        assert curve.frequency is None
    told = Curve(*away, mu=1.0, frequency=1.0)
    np.testing.assert_allclose(told.start()[0][2:], [2.0, 1.0], atol=1e-12)
