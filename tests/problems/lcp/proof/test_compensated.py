"""Products in twice the working precision by slices: within the bound, whatever the entries."""

from fractions import Fraction

import numpy as np
import pytest

from problems.lcp import MixedLCP
from problems.lcp.proof.compensated import accurate_w


@pytest.mark.parametrize("zeros", [0.0, 0.1, 0.9])
@pytest.mark.parametrize("unit", [1.0, 1e-120, 1e120])
def test_slices_of_large_matrices_are_within_the_bound(zeros, unit):
    """Entries over thirty orders of magnitude, rows of zeros, and rows that cancel."""
    rng = np.random.default_rng(3)
    n = 130
    A = rng.standard_normal((n, n)) * np.exp(7.0 * rng.standard_normal((n, n)))
    A[5] = 0.0
    x = rng.standard_normal(n) * np.exp(7.0 * rng.standard_normal(n)) * unit * (rng.random(n) >= zeros)
    q = -(A @ x)
    q[7] = 1.0
    w, bound = accurate_w(MixedLCP(A, q), x)
    for i in (0, 5, 7, 50, n - 1):
        exact = sum((Fraction(a) * Fraction(b) for a, b in zip(A[i], x)), Fraction(q[i]))
        assert abs(Fraction(w[i]) - exact) <= Fraction(bound[i])
    assert (bound <= 1e-24 * (np.abs(A) @ np.abs(x) + np.abs(q)) + 3e-16 * np.abs(w) + 1e-290).all()
