"""The series of a path, in plain numpy of any style, against closed forms."""

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import lu_factor, lu_solve

from continuation.jets import jacobian, path_series

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
