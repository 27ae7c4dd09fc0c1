"""The series of a path, in plain numpy of any style, against closed forms."""

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import lu_factor, lu_solve

from continuation.jets import Jet, evaluate, jacobian, path_series

ORDER = 20


def solver(residual, u0, border):
    full = np.vstack([jacobian(lambda u: residual(u[:-1], u[-1]), u0), border])
    factors = lu_factor(full)
    return lambda r, rho: lu_solve(factors, np.append(r, rho))


def circle(y, lam):
    return y**2 + lam**2 - 1


@pytest.mark.parametrize(
    "residual",
    [
        circle,
        lambda y, lam: np.array([y[0] ** 2 + lam**2 - 1]),
        lambda y, lam: [y[0] ** 2 + lam**2 - 1],
        lambda y, lam: y[0] ** 2 + lam**2 - 1,
    ],
)
def test_path_series_of_the_circle(residual):
    # from (0, 1) along (1, 0) with border . (u - u0) = s: y = s, lam = sqrt(1 - s^2)
    tangent = np.array([1.0, 0.0])
    u0 = np.array([0.0, 1.0])
    found = path_series(residual, u0, tangent, solver(circle, u0, tangent), ORDER)
    with mp.workdps(50):
        root = mp.taylor(lambda s: mp.sqrt(1 - s * s), 0, ORDER)
    assert np.array_equal(found[:, 0], np.eye(ORDER + 1)[1])
    np.testing.assert_allclose(found[:, 1], np.array(root, dtype=float), rtol=1e-13, atol=1e-16)


def test_path_series_of_bratu_in_plain_numpy():
    n, h = 20, 1 / 21
    second = (np.eye(n, k=1) - 2 * np.eye(n) + np.eye(n, k=-1)) / h**2

    styles = (
        lambda y, lam: second @ y + lam * np.exp(y),
        lambda y, lam: np.diff(np.concatenate([[0.0], y, [0.0]]), 2) / h**2 + lam * np.exp(y),
    )
    y, lam = np.zeros(n), 1.0
    for _ in range(20):
        y = y - np.linalg.solve(second + lam * np.diag(np.exp(y)), styles[0](y, lam))
    tangent = np.append(np.linalg.solve(second + lam * np.diag(np.exp(y)), -np.exp(y)), 1.0)
    u0, tangent = np.append(y, lam), tangent / np.linalg.norm(tangent)
    for residual in styles:
        c = path_series(residual, u0, tangent, solver(residual, u0, tangent), 12)
        assert np.array_equal(c[:2], [u0, tangent])
        assert np.all(np.abs(c[2:] @ tangent) < 1e-13 * np.abs(c[2:]).max())
        for s in (0.05, 0.1):  # the residual along the series falls like s^13
            u = evaluate(Jet(c), s)
            assert np.abs(residual(u[:-1], u[-1])).max() < 1e4 * np.abs(c[-1]).max() * s**13 + 1e-10
