"""Homotopies for F(x) = 0: derivatives in every matrix structure, capabilities by presence, checks at the door."""

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array, issparse

from continuation.linear import Banded
from problems.nonlinear import brown, fixed_point, newton

both = pytest.mark.parametrize("make", [fixed_point, newton])


def complex_step(function, u):
    return np.stack([function(row).imag * 1e200 for row in u + 1e-200j * np.eye(u.size)], axis=1)


def whole(homotopy):
    return lambda u: homotopy.residual(u[:-1], u[-1])


@pytest.mark.parametrize("zeros", [0, 1, 2])
@pytest.mark.parametrize("n", [2, 5])
def test_brown_jacobian_also_where_components_vanish(n, zeros):
    x = np.random.default_rng(n).normal(size=n)
    x[:zeros] = 0.0
    np.testing.assert_allclose(brown(n).jacobian(x), complex_step(brown(n), x), rtol=0, atol=1e-13)


def test_brown_of_another_size_is_refused():
    with pytest.raises(ValueError, match=r"x: expected shape \(3,\), found \(2,\)"):
        brown(3)(np.zeros(2))
    with pytest.raises(ValueError, match="n: expected at least 1, found 0"):
        brown(0)


TRIDIAGONAL = np.diag([2.0, 3.0, 4.0, 5.0]) + np.diag([1.0, 1.0, 1.0], 1) + np.diag([1.0, 1.0, 1.0], -1)


def banded(x):
    bands = np.zeros((3, 4))
    bands[0, 1:] = bands[2, :-1] = 1.0
    bands[1] = TRIDIAGONAL.diagonal() + 3 * x**2
    return Banded(bands, 1, 1)


def cubic(x):
    return TRIDIAGONAL @ x + x**3 - 1.0


def cubic_slope(x):
    return TRIDIAGONAL + np.diag(3 * x**2)


@both
@pytest.mark.parametrize(
    ("slope", "kind"),
    [
        (cubic_slope, np.ndarray),
        (lambda x: csr_array(cubic_slope(x)), csr_array),
        (lambda x: csc_array(cubic_slope(x)), csc_array),
        (banded, Banded),
    ],
    ids=["dense", "csr", "csc", "banded"],
)
def test_the_structure_of_the_derivative_is_kept(make, slope, kind):
    homotopy = make(cubic, np.full(4, 0.5), slope)
    u = np.array([0.3, -0.7, 1.1, 0.2, 0.6])
    H_y, H_lam = homotopy.jacobian(u[:-1], u[-1])
    assert isinstance(H_y, kind)
    dense = H_y.toarray() if issparse(H_y) else H_y @ np.eye(4)
    np.testing.assert_allclose(np.column_stack((dense, H_lam)), complex_step(whole(homotopy), u), rtol=0, atol=1e-13)


def test_blending_leaves_the_given_matrix_alone():
    kept = banded(np.zeros(4))
    bands = kept.ab.copy()
    fixed_point(cubic, np.zeros(4), lambda x: kept).jacobian(np.zeros(4), 0.5)
    np.testing.assert_array_equal(kept.ab, bands)


@both
@pytest.mark.parametrize(
    ("F", "a", "jacobian", "error", "message"),
    [
        (cubic, [], None, ValueError, r"a: expected a vector of real numbers, found shape \(0,\)"),
        (lambda x: [0.0], [0.0], None, TypeError, r"F\(a\): expected an array of shape \(1,\), found list"),
        (lambda x: x[:1], [0.0, 1.0], None, ValueError, r"F\(a\): expected shape \(2,\), that of a, found \(1,\)"),
        (lambda x: np.log(x), [-1.0], None, ValueError, r"F\(a\): expected finite numbers, found nan"),
        (lambda x: x + 1j, [0.0], None, ValueError, r"F\(a\): expected real numbers.*complex128"),
        (cubic, np.zeros(4), lambda x: 1.0, TypeError, r"jacobian\(a\): expected a matrix"),
        (
            cubic,
            np.zeros(4),
            lambda x: np.eye(3),
            ValueError,
            r"jacobian\(a\): expected shape \(4, 4\), found \(3, 3\)",
        ),
    ],
)
def test_wrong_input_is_named_at_the_door(make, F, a, jacobian, error, message):
    with pytest.raises(error, match=message):
        make(F, a, jacobian)


@both
def test_wild_iterates_make_no_noise(make):
    # Warnings are errors in this suite; Brown's product overflows here.
    F = brown(4)
    homotopy = make(F, np.zeros(4), F.jacobian)
    for size in (1e200, np.inf, np.nan):
        assert not np.isfinite(homotopy.residual(np.full(4, size), 0.5)).all()
        homotopy.jacobian(np.full(4, size), 0.5)
