"""The bounds of Krawczyk's test for quadratic homotopies beside what they bound, evaluated at random places."""

from fractions import Fraction

import numpy as np
import pytest

from continuation import certify, trace
from continuation.certificate.cells import Cells, Slabs, evaluated, slabs_of
from continuation.certificate.certifying import engine_of
from continuation.numbers.ends import thin
from problems.lcp import LCP
from problems.lcp.homotopies import KKTHomotopy, YuHomotopy
from problems.lcp.quadratic.polynomial import Polynomial

SLACK = 1.0 + 1e-6
"""What is evaluated has round-off of its own, at most 1e-9 of the bounds, whose single precision is coarser."""


@pytest.mark.parametrize("scale", [1.0, 1e-9, 1e-300, 1e-320])
def test_the_coefficients_of_a_cubic_are_enclosed(scale):
    rng = np.random.default_rng(1)
    begin, first, last, off = rng.normal(size=(4, 40, 3)) * scale
    begin[::4], first[:, 0], last[:, 0], off[:, 0] = begin[::4] / scale, 0.0, 0.0, 0.0
    nothing, one = np.zeros((40, 3)), np.ones(40, dtype=np.intp)
    cells = Cells(begin, begin + off, first, last, nothing, nothing, one, nothing[:, :2])
    middle = np.where(np.arange(40) % 5, rng.uniform(-1e-3, 1.001, 40), np.arange(40) % 2)
    slabs = Slabs(np.arange(40), middle, rng.uniform(0.0, 0.5, 40), cells)
    q, rate = [slabs.cubic[:, k] for k in range(4)], slabs.over[1]
    for k, j in np.ndindex(40, 3):
        m = Fraction(float(middle[k]))
        a, b, c, d = (Fraction(float(x[k, j])) for x in (cells.begin, cells.end, first, last))
        a2, a3 = 3 * (b - a) - 2 * c - d, c + d - 2 * (b - a)
        exact = [a + m * (c + m * (a2 + m * a3)), c + m * (2 * a2 + 3 * m * a3), a2 + 3 * m * a3, a3]
        for one_of_them, value in zip(q, exact):
            lo, hi = (float(x[k, j]) for x in (one_of_them.lo, one_of_them.hi))
            assert Fraction(lo) <= value <= Fraction(hi)
            assert hi - lo <= 1e-13 * float(max(map(abs, (a, b, c, d)))) + 1e-321
        for x in (-slabs.half[k], 0.3 * slabs.half[k], slabs.half[k]):
            x = Fraction(float(x))
            assert Fraction(float(rate.lo[k, j])) <= exact[1] + x * (2 * exact[2] + 3 * x * a3) <= float(rate.hi[k, j])


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
