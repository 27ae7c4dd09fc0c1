"""Homotopies for F(x) = 0: derivatives in every matrix structure, capabilities by presence, checks at the door."""

from functools import partial

import numpy as np
import pytest

from problems.nonlinear import brown, fixed_point, newton

from .util import FORMS, cubic, cubic_slope


@pytest.mark.parametrize("zeros", [0, 1, 2])
@pytest.mark.parametrize("n", [2, 5])
def test_brown_jacobian_also_where_components_vanish(n, zeros):
    x = np.random.default_rng(n).normal(size=n)
    x[:zeros] = 0.0
    exact = [brown(n)(row).imag * 1e200 for row in x + 1e-200j * np.eye(n)]
    np.testing.assert_allclose(brown(n).jacobian(x), np.transpose(exact), rtol=0, atol=1e-13)


@pytest.mark.parametrize("make", [fixed_point, newton])
@pytest.mark.parametrize("form", FORMS)
def test_the_structure_of_the_derivative_is_kept(make, form):
    slope, y = partial(cubic_slope, form), np.array([0.3, -0.7, 1.1, 0.2])
    homotopy = make(cubic, np.full(4, 0.5), slope)
    H_y, H_lam = homotopy.jacobian(y, 0.6)
    assert type(H_y) is type(slope(y))
    exact = [homotopy.residual(u[:-1], u[-1]).imag * 1e200 for u in np.append(y, 0.6) + 1e-200j * np.eye(5)]
    np.testing.assert_allclose(np.column_stack((H_y @ np.eye(4), H_lam)), np.transpose(exact), rtol=0, atol=1e-13)
