"""Products in twice the working precision: within the bound, whatever the entries and their storage."""

from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp

from problems.lcp import MixedLCP
from problems.lcp.proof.compensated import error_bound, row_terms


@pytest.mark.parametrize("unit", [1.0, 1e-120, 1e120])
@pytest.mark.parametrize(("n", "zeros"), [(130, 0.0), (130, 0.1), (130, 0.9), (30, 0.0)])
@pytest.mark.parametrize("make", [np.asarray, sp.csr_array])
def test_sums_are_within_the_bound(make, n, zeros, unit):
    """Entries over thirty orders of magnitude, rows of zeros, and rows that cancel; of any length where sparse."""
    rng = np.random.default_rng(3)
    A = rng.standard_normal((n, n)) * np.exp(7.0 * rng.standard_normal((n, n)))
    A[5] = 0.0
    if make is sp.csr_array:
        A *= rng.random((n, n)) < rng.random(n)[:, None]
    x = rng.standard_normal(n) * np.exp(7.0 * rng.standard_normal(n)) * unit * (rng.random(n) >= zeros)
    q = -(A @ x)
    q[7] = 1.0
    terms = row_terms(MixedLCP(make(A), q), x)
    w, bound = terms.whole, error_bound(terms.w, terms.size, n + 1)
    for i in (0, 5, 7, 20, n - 1):
        exact = sum((Fraction(a) * Fraction(b) for a, b in zip(A[i], x)), Fraction(q[i]))
        assert abs(Fraction(w[i]) - exact) <= Fraction(bound[i])
    assert (bound <= 1e-24 * (np.abs(A) @ np.abs(x) + np.abs(q)) + 3e-16 * np.abs(w) + 1e-290).all()
