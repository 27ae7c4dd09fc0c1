"""The LCP homotopies: their equations, by hand, and how far they go."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from problems import lcp
from problems.lcp.homotopies.quadratics import form
from problems.lcp.strategies import lcps

from .util import every, made


def test_kkt_equations_by_hand():
    homotopy = lcp.KKTHomotopy(lcp.LCP([[2.0]], [-3.0]), [1.0], [5.0], [7.0], [4.0])
    # rho = 4 - (2 - 3) = 5, c1 = 5, c2 = 28; at x = 2, z1 = 3, z2 = 6, lambda = 1/4: w = 1 + 5/4.
    expected = [0.75 * (4 * 2 - 3 - 3 - 2 * 6) + 0.25 * (2 - 1), 3 * 2 - 0.25 * 5, 6 * 2.25 - 0.25 * 28]
    assert homotopy.residual(np.array([2.0, 3.0, 6.0]), 0.25) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("make", "first"),
    [
        (lcp.YuHomotopy, 0.75 * (1 - 6) + 0.25 * (2 - 1)),
        (lcp.ZhaoHomotopy, 0.75 * (6 - 1) + 0.25 * (2 - 1)),
        (lcp.XuHomotopy, 0.75 * (6 - 1) - 0.25 * (2 - 1)),
        (lcp.WangHomotopy, 0.75 * 1 - 6 + 0.25 * 4),
        (lcp.KojimaMegiddoMizunoHomotopy, 1 - 6 + 0.25 * (4 - (-1))),
    ],
)
def test_two_vector_equations_by_hand(make, first):
    homotopy = make(lcp.LCP([[2.0]], [-3.0]), [1.0], [4.0])
    # x = 2, y = 6, lambda = 1/4: A x + q = 1.
    assert homotopy.residual(np.array([2.0, 6.0]), 0.25) == pytest.approx([first, 2 * 6 - 0.25 * 4], rel=1e-15)


def test_the_rounded_sums_of_a_proof_are_within_their_bounds():
    """Of A + A', whose entries differ by many orders of magnitude, in exact arithmetic."""
    rng = np.random.default_rng(0)
    A = rng.standard_normal((5, 5)) * 10.0 ** rng.uniform(-8, 8, (5, 5))
    second = form(lcp.KKTHomotopy(lcp.LCP(A, np.ones(5)))).second
    for i, j in np.ndindex(5, 5):
        exact = Fraction(i == j) - Fraction(A[i, j]) - Fraction(A[j, i])
        assert abs(Fraction(second.matrix[i, j]) - exact) <= Fraction(second.error[i, j])


def positives(homotopy, u):
    if isinstance(homotopy, lcp.KKTHomotopy):
        return np.append(u[:-1], homotopy.problem.w(u[: homotopy.n]) + u[-1] * homotopy.rho)
    return u[:-1]


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_max_step_is_sharp(make, problem, seed):
    rng = np.random.default_rng(seed)
    homotopy = made(make, problem, rng)
    u = np.append(homotopy.start()[0], 1.0)
    v = rng.standard_normal(u.size)
    h = homotopy.max_step(u, v)
    assert h > 0.0
    assert (positives(homotopy, u + min(h * (1 - 1e-9), 1e6) * v) > 0.0).all()
    assert h == np.inf or not (positives(homotopy, u + h * (1 + 1e-9) * v) > 0.0).all()
