"""Curves of Hopf points, with their frequencies."""

import numpy as np
import pytest

import continuation
from continuation import Curve, Family, Kind, LocatedEvent, Status

from .util import Brusselator, CuspForm, Diffusing, Lorenz, TakensBogdanov, VanDerPol, ZeroHopf, named


def test_lorenz():
    homotopy = Lorenz()
    curve = Curve(Family(homotopy, "b"), Kind.HOPF, homotopy.wing(25.0))
    path = continuation.trace(curve, box={"lam": (None, 8.0)}, tolerance=1e-12)
    r, frequency, b = path.u[:, 3:].T
    assert abs(r[0] - 470.0 / 19.0) <= 1e-10
    assert abs(frequency[0] - np.sqrt(8.0 / 3.0 * (470.0 / 19.0 + 10.0))) <= 1e-10
    assert np.abs(r - 10.0 * (13.0 + b) / (9.0 - b)).max() <= 1e-10
    assert np.abs(frequency**2 - b * (r + 10.0)).max() <= 1e-9
    assert path.lam[-1] == 8.0


def test_brusselator():
    homotopy = Brusselator()
    path = continuation.trace_both(
        Curve(Family(homotopy, "A"), Kind.HOPF, (np.array([1.0, 2.0]), 2.1)),
        box={"lam": (0.25, 4.0)},
        tolerance=1e-12,
    )
    B, frequency, A = path.u[:, 2:].T
    assert np.abs(B - 1.0 - A**2).max() <= 1e-10
    assert np.abs(frequency - A).max() <= 1e-10
    assert (A.min(), A.max()) == (0.25, 4.0)


def test_van_der_pol():
    curve = Curve(Family(VanDerPol(), "k"), Kind.HOPF, (np.zeros(2), 0.05))
    path = continuation.trace(curve, box={"lam": (None, 1.5)})
    assert np.abs(path.y[:, :3]).max() <= 1e-10
    assert np.abs(path.y[:, 3] - np.sqrt(path.lam)).max() <= 1e-10


def test_it_ends_where_its_frequency_is_zero():
    curve = Curve(Family(TakensBogdanov(), "mu"), Kind.HOPF, (np.array([-1.0, 0.0]), -1.0))
    path = continuation.trace(curve, direction=-1, tolerance=1e-12)
    assert path.status is Status.STOPPED_AT_EVENT
    y, _, lam, frequency, mu = path.u.T
    assert np.abs(y + mu).max() <= 1e-10
    assert np.abs(lam + mu**2).max() <= 1e-10
    assert np.abs(frequency**2 - 2.0 * mu).max() <= 1e-10
    (end,) = named(path, "Bogdanov-Takens")
    assert np.abs(end.u).max() <= 1e-10


def test_it_passes_where_the_equilibrium_turns():
    curve = Curve(Family(ZeroHopf(), "mu"), Kind.HOPF, (np.array([-1.0, 0.0, 0.0]), 1.0))
    path = continuation.trace(curve, direction=-1, box={"lam": (-1.5, None)}, tolerance=1e-12)
    assert np.abs(path.y[:, 3] - path.lam**2).max() <= 1e-10
    assert np.abs(path.y[:, 4] - 2.0).max() <= 1e-10
    (point,) = named(path, "zero-Hopf")
    assert np.abs(point.u - [0.0, 0.0, 0.0, 0.0, 2.0, 0.0]).max() <= 1e-10


@pytest.mark.parametrize(("n", "accuracy"), [(10, 1e-10), (300, 1e-9)])
def test_sparse(n, accuracy):
    homotopy = Diffusing(n=n)
    B, frequency = homotopy.hopf
    curve = Curve(Family(homotopy, "A"), Kind.HOPF, homotopy.at(B + 0.01))
    path = continuation.trace(curve, box={"lam": (None, 1.2)})
    exact = np.array([Diffusing(A, n).hopf for A in path.lam])
    assert np.abs(path.u[:, -3:-1] - exact).max() <= accuracy
    assert abs(path.y[0, -1] - frequency) <= accuracy


def test_a_located_point_will_do():
    homotopy = Brusselator()
    u = np.array([1.0, 2.0, 2.0])
    event = LocatedEvent("Hopf point", Kind.HOPF, 0.0, u, np.array([0.0, 1.0, 1.0]), 0.0, 0.0, 1, 1)
    y, A = Curve(Family(homotopy, "A"), event).start()
    np.testing.assert_allclose(y, [1.0, 2.0, 2.0, 1.0], atol=1e-13)
    assert A == 1.0


def test_no_pair_near_the_axis_is_said():
    curve = Curve(Family(CuspForm(), "mu"), Kind.HOPF, (np.zeros(1), 0.0))
    with pytest.raises(
        ValueError, match="at: expected a pair of eigenvalues of H_y near the imaginary axis, found none"
    ):
        continuation.trace(curve)
    curve = Curve(Family(Brusselator(), "A"), Kind.HOPF, (np.array([1.0, 1.2]), 1.2))
    with pytest.raises(ValueError, match=r"near the imaginary axis, found -0.4\+0.917j"):
        continuation.trace(curve)
    assert curve.frequency is None
    told = Curve(Family(Brusselator(), "A"), Kind.HOPF, (np.array([1.0, 1.2]), 1.2), frequency=1.0)
    np.testing.assert_allclose(told.start()[0][2:], [2.0, 1.0], atol=1e-12)
