"""Certificates: compensated residuals against Fractions, exact solutions, Farkas multipliers against exact truth."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from problems.lcp import LCP, MixedLCP, Outcome, solve
from problems.lcp.classes.simplex import at_least, feasible_point
from problems.lcp.proof.certificate import certify, certify_exactly, farkas
from problems.lcp.proof.farkas import infeasibility

from ....exact import check_farkas, exact_w, solves

SMALL = st.integers(-2, 2)


def dense_or_sparse(A, q, sparse):
    return LCP(sp.csr_array(A) if sparse else A, q)


NO_SOLUTIONS = {
    # x = t (1, 1) solves LCP(0, A), so the relative residual falls like 1/t although no solution exists.
    "runs to infinity": ([[1.0, -1.0], [-1.0, 1.0]], [-1.0, -1.0], [1e12, 1e12], 5e-13, 1.0),
    "runs to infinity alone": ([[0.0, 0.0], [1.0, 0.0]], [-1.0, 0.0], [1e12, 0.0], 1.0, 1.0),
    "its products overflow": ([[1e200, -1e200], [0.0, 1.0]], [0.0, 0.0], [1e200, 1e200], 1.0, 0.0),
    # -1e-200 times 1e-200 is no zero: it is all that its row is made of.
    "its products underflow": ([[-1e-200, -1e-200], [0.0, -1.0]], [0.0, 0.0], [1e-200, 0.0], 1.0, 0.0),
    # The rounding of x3 must not excuse w3 = -5.
    "a huge x": ([[0, -1, 0], [3, 0, 0], [0, -2, 0]], [3.0, -3.0, 1.0], [1.0, 3.0, 1.5e17], 5 / 7, 5 / 12),
}


@pytest.mark.parametrize(("A", "q", "x", "relative", "drowned"), NO_SOLUTIONS.values(), ids=NO_SOLUTIONS)
def test_what_solves_nothing_is_not_certified(A, q, x, relative, drowned):
    certificate = certify(LCP(A, q), np.array(x))
    assert not certificate.solves()
    assert (certificate.relative_residual, certificate.drowned) == pytest.approx((relative, drowned), rel=1e-9, abs=0.0)


def test_products_that_no_float_holds_are_certified():
    small = certify(LCP([[1e-200, 0.0], [0.0, 1.0]], [-1e-300, 0.0]), np.array([1e-100, 0.0]))
    assert small.solves()
    assert certify(LCP([[1e200]], [0.0]), np.array([1e200])).w[0] == np.inf


def test_parts_of_the_certificate():
    certificate = certify(LCP([[1.0, 0.0], [0.0, 1.0]], [1.0, -4.0]), np.array([-0.5, 3.0]))
    assert certificate.residual == 1.0
    # x1 = -1/2 is 1/3 of the terms of row 1, 1/2 + 1, and w2 = -1 is 1/7 of those of row 2, 3 + 4.
    assert certificate.relative_residual == 1.0 / 3.0


@given(st.data(), st.integers(1, 4), st.booleans(), st.sampled_from([0.0, 1e-9]))
@settings(deadline=None)
def test_exact_certificate_is_sound_and_finds_planted_solutions(data, n, sparse, noise):
    """Small integers, planted solution (degenerate and singular ones too): certified from its floats, and near them."""
    A = data.draw(arrays(np.int64, (n, n), elements=SMALL))
    x = data.draw(arrays(np.int64, n, elements=st.integers(0, 3)))
    w = np.where(x > 0, 0, data.draw(arrays(np.int64, n, elements=st.integers(0, 2))))
    problem = dense_or_sparse(A, w - A @ x, sparse)
    certificate = certify_exactly(problem, x + noise * np.where(x > 0, [1, -1, 2, 1][:n], 0))
    assert certificate.solves
    assert list(exact_w(problem, certificate.x)) == list(certificate.w)
    anywhere = certify_exactly(problem, data.draw(arrays(float, n, elements=st.floats(-2, 4))))
    assert not anywhere.solves or solves(problem, anywhere.x)


WRONG = "The exact point of the active set violates a bound or the sign of some w_i."


@pytest.mark.parametrize(
    ("A", "q", "bounds", "x", "message"),
    [
        ([[-1.0]], [-1.0], (0.0, np.inf), [1.0], WRONG),
        ([[1.0, 0.0], [-1.0, 1.0]], [-1.0, 0.5], (0.0, np.inf), [0.1, 0.0], WRONG),
        ([[1.0, 0.0], [100.0, 1.0]], [-2.01, 0.0], (0.0, 2.0), [1.5, 0.0], WRONG),
        ([[1.0, 0.0], [1.0, 1.0]], [-1.0, -2.5], (-np.inf, [np.inf, 2.0]), [0.1, 2.0], WRONG),
        ([[0.0]], [-1.0], (0.0, np.inf), [1.0], "The equations w_i = 0 of the active set are inconsistent."),
    ],
)
def test_no_exact_certificate_without_a_solution(A, q, bounds, x, message):
    certificate = certify_exactly(MixedLCP(A, q, *bounds), np.array(x))
    assert not certificate.solves
    assert certificate.message.endswith(message)
    if "inconsistent" in message:
        with pytest.raises(ValueError, match=r"^x: there is no exact point"):
            _ = certificate.x_rounded


def test_exact_certificate_of_random_floats_at_order_forty_and_a_refusal_beyond():
    rng = np.random.default_rng(0)
    A, x = rng.standard_normal((40, 40)), np.maximum(rng.standard_normal(40), 0.0)
    certificate = certify_exactly(LCP(A, np.where(x > 0, 0.0, 1.0) - A @ x), x)
    assert certificate.solves
    np.testing.assert_allclose(certificate.x_rounded, x, atol=1e-11)
    with pytest.raises(ValueError, match=r"^x: expected an active set of at most"):
        certify_exactly(LCP(sp.eye_array(500), -np.ones(500)), np.ones(500))


@given(st.data(), st.integers(1, 3), st.booleans())
@settings(deadline=None, max_examples=150)
def test_farkas_against_exact_truth(data, n, sparse):
    A = data.draw(arrays(np.int64, (n, n), elements=SMALL))
    q = data.draw(arrays(np.int64, n, elements=SMALL))
    problem = dense_or_sparse(A, q, sparse)
    proof = farkas(problem)
    rows = [at_least(row, -int(right)) for row, right in zip(A.tolist(), q)]
    assert (proof is None) == (feasible_point(rows, n) is not None)
    if proof is not None:
        check_farkas(problem, proof)


@given(st.data(), st.integers(1, 4), st.integers(-8, 8))
@settings(deadline=None)
def test_farkas_of_planted_multipliers_at_all_scales(data, n, exponent):
    """A'y <= 0 and q'y < 0 with small integers, then rows over many powers of two: proved at every scale."""
    y = data.draw(arrays(np.int64, n, elements=st.integers(0, 3)))
    assume(y.any())
    A = data.draw(arrays(np.int64, (n, n), elements=SMALL))
    i = int(np.argmax(y))
    A[i] -= -(-np.maximum(A.T @ y, 0) // y[i])  # the ceiling: row i takes off what is positive
    assert (A.T @ y <= 0).all()
    scale = 8.0 ** (exponent * np.arange(n))
    problem = LCP(scale[:, None] * A, -scale)
    proof = farkas(problem)
    check_farkas(problem, proof)


@pytest.mark.parametrize("sparse", [False, True])
def test_farkas_whose_columns_are_all_tight(sparse):
    """Columns of both signs force A'y = 0, so y = (b, a) up to a factor: no rounding of floats is exact."""
    a, b = 912_345_678_901, 702_345_678_907
    problem = dense_or_sparse([[a, -a], [-b, b]], [-1.0, 1.0 / 3.0], sparse)
    proof = farkas(problem)
    check_farkas(problem, proof)
    assert proof.y == (b, a)
    # A ray of pivots that is off in its last digits leads there in any units.
    for rows in 2.0 ** np.array([[-30, 30], [0, 0], [30, -30]]):
        scaled = LCP(rows[:, None] * [[a, -a], [-b, b]], rows * problem.q)
        assert infeasibility(scaled, guess=np.array([b, (1.0 + 1e-9) * a]) / rows).holds(scaled)


def test_a_solution_that_falls_off_below_the_smallest_number_is_one():
    n, e = 90, 1e-4
    A = sp.diags_array([np.full(n - 1, -e), np.full(n, 1.0 + 2.0 * e), np.full(n - 1, -e)], offsets=[-1, 0, 1])
    q = np.zeros(n)
    q[0] = -1.0
    found = solve(LCP(A, q))
    assert found.outcome is Outcome.SOLVED
    # What is small because everything is is judged as before.
    assert certify(LCP(A, 1e-300 * q), np.zeros(n)).relative_residual == 1.0
    # x1 = x0 / 1000 rounds to zero, where w1 = 0 presses nothing.
    assert certify(LCP([[1.0, -1000.0], [0.0, 0.0]], [0.0, 0.0]), np.array([100 * 5e-324, 0.0])).solves()
    off = found.x.copy()
    off[5] *= 1.001
    assert not certify(LCP(A, q), off).solves()


def test_what_no_float_holds_makes_up_for_no_row_with_a_term_that_a_float_holds():
    # Row 0 asks for x1 = 1e-341, and row 1 allows it; but the term of x0 is all that the row has.
    A = np.array([[1e-186, -1e-16], [1e123, 1e8]])
    for unit in (1.0, 1e170):
        scaled = LCP(A * [[unit], [1.0]], [0.0, -1e-48])
        assert certify(scaled, np.array([1e-171, 0.0])).relative_residual > 0.4
    # w1 is pressed against zero: x1 is zero, and row 0 is off by all of it.
    assert certify(LCP(A, [0.0, 1.0]), np.array([1e-171, 0.0])).relative_residual == 1.0
    B = [[0.0, 1e-22, -1e-176], [2e124, 0.0, -1e198], [1e-12, -5e-5, 8e59]]
    assert certify(LCP(B, [0.0, 4e163, -4e-159]), np.array([0.0, 0.0, 5e-219])).relative_residual == 1.0
