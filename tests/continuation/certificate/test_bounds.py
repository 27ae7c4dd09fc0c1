"""The bounds of Krawczyk's test for quadratic homotopies beside what they bound, evaluated at random places."""

import numpy as np
import pytest

from continuation import certify, trace
from continuation.certificate.cells import evaluated, slabs_of
from continuation.certificate.certifying import engine_of
from continuation.numbers.ends import thin
from problems.lcp import LCP
from problems.lcp.homotopies import KKTHomotopy, YuHomotopy
from problems.lcp.quadratic.polynomial import Polynomial

SLACK = 1.0 + 1e-6
"""What is evaluated has round-off of its own, at most 1e-9 of the bounds, whose single precision is coarser."""


@pytest.mark.parametrize("Homotopy", [KKTHomotopy, YuHomotopy])
@pytest.mark.parametrize("n", [4, 25])
def test_what_is_bounded_is_smaller(Homotopy, n):
    rng = np.random.default_rng(n)
    half = rng.normal(size=(n, n))
    homotopy = Homotopy(LCP(half @ half.T / n, rng.normal(size=n)))
    path = trace(homotopy)
    slabs = slabs_of(certify(path, homotopy).cells)
    assert len(slabs) > 3
    radius = slabs.cells.radius
    judged = engine_of(homotopy).judge(slabs, radius)
    assert isinstance(judged, Polynomial)
    misfit, spread = judged.misfit, judged.spread(radius, radius)
    shares = []
    for _ in range(20):
        x = slabs.offset * rng.uniform(-1.0, 1.0, len(slabs))
        p = evaluated(slabs.cubic, thin(x[:, None]))[0].middle()
        for k, (at, d) in enumerate(zip(p, rng.choice([-1.0, 1.0], p.shape) * radius)):
            Y = judged.d[k][:, None] * (
                (np.eye(p.shape[1]) - x[k] * judged.E[k] + x[k] ** 2 * judged.C[k]) @ judged.Y[k]
            )
            whole = np.vstack([np.column_stack(homotopy.jacobian((at + d)[:-1], (at + d)[-1])), slabs.cells.chart[k]])
            signs = rng.choice([-1.0, 1.0], radius.shape[1])
            left = np.abs(signs * radius[k] - Y @ (whole @ (signs * radius[k])))
            value = np.abs(Y[:, :-1] @ homotopy.residual(at[:-1], at[-1]))
            shares.append(((left / spread[k]).max(), (value / misfit[k]).max()))
    shares = np.array(shares)
    assert (shares <= SLACK).all()
    # Bounds that are far too large would prove nothing.
    assert shares.max(axis=0)[0] > 0.1


@pytest.mark.parametrize("A", [np.eye(2), [[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 1.0]]])
def test_an_end_at_which_all_of_a_row_is_zero_is_proved_in_rationals(A):
    q = np.append([-1.0, 1.0][: len(A) - 1], 0.0)
    homotopy = KKTHomotopy(LCP(A, q))
    proof = certify(trace(homotopy), homotopy)
    assert proof.complete
    assert "rational arithmetic" in proof.end
