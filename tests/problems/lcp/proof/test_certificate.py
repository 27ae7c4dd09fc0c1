"""Certificates: compensated residuals against Fractions, exact solutions, Farkas multipliers against exact truth."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from problems.lcp import LCP, Outcome, solve
from problems.lcp.proof.certificate import certify, certify_exactly, farkas
from problems.lcp.proof.compensated import accurate_w
from problems.lcp.proof.rational import PRIMES, solve_exactly
from problems.paper import COUNTEREXAMPLES, EXAMPLES

from ....exact import check_farkas, exact_w, gauss_jordan, solves

SMALL = st.integers(-2, 2)
WIDE = st.floats(-1e40, 1e40, allow_nan=False).filter(lambda v: v == 0 or abs(v) > 1e-40)


def dense_or_sparse(A, q, sparse):
    return LCP(sp.csr_array(A) if sparse else A, q)


def has_feasible_point(A, q):
    """Whether {x >= 0, A x + q >= 0} has a vertex: it is pointed, so it has one if it is not empty. Exact."""
    n = len(q)
    rows = [[int(i == j) for j in range(n)] for i in range(n)] + A.astype(int).tolist()
    least = [0] * n + (-q.astype(int)).tolist()
    for chosen in combinations(range(2 * n), n):
        x, _ = gauss_jordan([rows[i] for i in chosen], [least[i] for i in chosen])
        if x is not None and all(sum(a * b for a, b in zip(row, x)) >= bound for row, bound in zip(rows, least)):
            return True
    return False


@given(st.data(), st.integers(1, 5), st.booleans())
@settings(deadline=None)
def test_accurate_w_is_within_its_bound(data, n, sparse):
    A = data.draw(arrays(float, (n, n), elements=WIDE))
    q, x = data.draw(arrays(float, n, elements=WIDE)), data.draw(arrays(float, n, elements=WIDE))
    problem = dense_or_sparse(A, q, sparse)
    w, bound = accurate_w(problem, x)
    for value, limit, truth in zip(w, bound, exact_w(problem, x)):
        assert abs(Fraction(value) - truth) <= Fraction(limit)


@pytest.mark.parametrize("sparse", [False, True])
def test_accurate_w_has_twice_the_precision(sparse):
    """Rows built to cancel to about 1e-16 of their terms: plain arithmetic has no digit, the compensated one all."""
    rng = np.random.default_rng(3)
    A, x = rng.standard_normal((30, 30)), rng.random(30)
    problem = dense_or_sparse(A, -(A @ x), sparse)
    truth = np.array([float(value) for value in exact_w(problem, x)])
    w, bound = accurate_w(problem, x)
    assert np.abs(truth).max() < 1e-14
    np.testing.assert_allclose(w, truth, rtol=1e-13)
    assert bound.max() <= 1e-26
    assert np.abs(problem.w(x) - truth).max() > 0.1 * np.abs(truth).max()


def test_products_beyond_the_range_of_floats_are_judged_without_overflow_or_warning():
    problem = LCP([[1e200, -1e200], [0.0, 1.0]], [0.0, 0.0])
    certificate = certify(problem, np.array([1e200, 1e200]))
    np.testing.assert_array_equal(certificate.w, [0.0, 1e200])
    assert certificate.relative_residual == 1.0
    assert not certificate.solves()
    assert certify(LCP([[1e200]], [0.0]), np.array([1e200])).w[0] == np.inf
    # 1e-200 times 1e-200 is no zero: w1 = -5e-401, which no float holds, is half of what its row is made of.
    small = certify(LCP([[1e-200, 0.0], [0.0, 1.0]], [-1e-300, 0.0]), np.array([1e-100, 0.0]))
    assert small.solves()
    assert not certify(LCP([[-1e-200, -1e-200], [0.0, -1.0]], [0.0, 0.0]), np.array([1e-200, 0.0])).solves()


def test_ragged_sparse_rows():
    A = np.array([[0.0, 0, 0, 0], [1, 2, 3, 4], [0, 5, 0, 6], [0, 0, 0, 7]])
    x = np.array([1.0, 10.0, 100.0, 1000.0])
    w, _ = accurate_w(LCP(sp.csr_array(A), -np.ones(4)), x)
    np.testing.assert_array_equal(w, A @ x - 1)


@pytest.mark.parametrize("sparse", [False, True])
def test_certificate_of_the_ten_examples(sparse):
    for item in EXAMPLES:
        x = np.array([float(value) for value in item.solutions[0]])
        certificate = certify(dense_or_sparse(item.A, item.q, sparse), x)
        assert certificate.solves(1e-14)
        assert certificate.residual <= 1e-14 * item.problem.scale(x)
        assert not certify(item.problem, x + 0.01).solves()


def test_parts_of_the_certificate():
    certificate = certify(LCP([[1.0, 0.0], [0.0, 1.0]], [1.0, -4.0]), np.array([-0.5, 3.0]))
    assert (certificate.negative_x, certificate.negative_w) == (0.5, 1.0)
    assert certificate.complementarity == 3.0
    assert certificate.residual == 1.0
    # x1 = -1/2 is 1/3 of the terms of row 1, 1/2 + 1, and w2 = -1 is 1/7 of those of row 2, 3 + 4.
    assert certificate.relative_residual == 1.0 / 3.0


def test_the_ends_of_the_counterexamples_are_not_certified():
    for item in COUNTEREXAMPLES:
        assert not certify(item.problem, item.end).solves(1e-3)


def test_a_point_running_to_infinity_is_not_called_a_solution():
    """x = t (1, 1) solves LCP(0, A), so the relative residual falls like 1/t although no solution exists."""
    problem = LCP([[1.0, -1.0], [-1.0, 1.0]], [-1.0, -1.0])
    certificate = certify(problem, np.array([1e12, 1e12]))
    assert certificate.relative_residual < 1e-10
    assert certificate.drowned == 1.0
    assert not certificate.solves()
    assert not certify(LCP([[0.0, 0.0], [1.0, 0.0]], [-1.0, 0.0]), np.array([1e12, 0.0])).solves()


def test_primes_are_prime():
    for prime in PRIMES:
        assert all(prime % k for k in range(2, int(prime**0.5) + 1))
        assert prime < 2**31


@given(st.data(), st.integers(1, 5), st.integers(1, 5))
@settings(deadline=None)
def test_solve_exactly_against_gauss_jordan(data, m, k):
    """Consistent systems of any shape and rank get an exact solution; inconsistent ones None."""
    matrix = data.draw(arrays(np.int64, (m, k), elements=st.integers(-3, 3))).astype(object)
    right = data.draw(st.lists(st.integers(-5, 5), min_size=m, max_size=m))
    guess = data.draw(arrays(float, k, elements=st.floats(-4, 4)))
    found = solve_exactly(matrix, right, guess)
    if found is not None:
        numerators, denominator = found
        assert denominator > 0
        assert list(matrix @ np.array(numerators, dtype=object)) == [b * denominator for b in right]
    else:
        augmented = np.hstack([matrix, np.array(right, dtype=object)[:, None]])
        assert exact_rank(augmented) == exact_rank(matrix) + 1
    if m == k:
        truth, _ = gauss_jordan(matrix.tolist(), right)
        if truth is not None:
            assert [Fraction(v, found[1]) for v in found[0]] == truth


def exact_rank(matrix):
    rows = [[Fraction(int(v)) for v in row] for row in matrix]
    rank = 0
    for j in range(len(rows[0])):
        pivot = next((i for i in range(rank, len(rows)) if rows[i][j] != 0), None)
        if pivot is None:
            continue
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        for i in range(rank + 1, len(rows)):
            factor = rows[i][j] / rows[rank][j]
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[rank])]
        rank += 1
    return rank


def test_a_determinant_divisible_by_the_first_prime():
    """Singular modulo the first prime, regular in truth: the next prime solves it."""
    matrix = np.array([[PRIMES[0], 0], [0, 1]], dtype=object)
    assert solve_exactly(matrix, [1, 2], np.array([0.0, 2.0])) == ([1, 2 * PRIMES[0]], PRIMES[0])


@pytest.mark.parametrize("sparse", [False, True])
@pytest.mark.parametrize("noise", [0.0, 1e-9])
def test_exact_certificates_of_the_ten_examples(sparse, noise):
    rng = np.random.default_rng(1)
    for item in EXAMPLES:
        problem = dense_or_sparse(item.A, item.q, sparse)
        for solution in item.solutions:
            x = np.array([float(value) for value in solution])
            certificate = certify_exactly(problem, x + noise * rng.standard_normal(x.size))
            assert certificate.solves
            np.testing.assert_allclose(certificate.x_rounded, x, rtol=1e-13)
            assert list(exact_w(problem, certificate.x)) == list(certificate.w)
            assert solves(problem, certificate.x)
            if item.number not in (5, 10):  # the others' decimals are exact in binary
                assert certificate.x == solution


@given(st.data(), st.integers(1, 4))
@settings(deadline=None)
def test_exact_certificate_is_sound_and_finds_planted_solutions(data, n):
    """Small integers, planted solution (degenerate and singular ones too): certified from its floats."""
    A = data.draw(arrays(np.int64, (n, n), elements=SMALL))
    x = data.draw(arrays(np.int64, n, elements=st.integers(0, 3)))
    w = np.where(x > 0, 0, data.draw(arrays(np.int64, n, elements=st.integers(0, 2))))
    problem = LCP(A, w - A @ x)
    certificate = certify_exactly(problem, x.astype(float))
    assert certificate.solves
    assert list(exact_w(problem, certificate.x)) == list(certificate.w)
    anywhere = certify_exactly(problem, data.draw(arrays(float, n, elements=st.floats(-2, 4))))
    assert not anywhere.solves or solves(problem, anywhere.x)


def test_no_exact_certificate_without_a_solution():
    for item in COUNTEREXAMPLES:
        certificate = certify_exactly(item.problem, item.end)
        assert not certificate.solves
        assert certificate.message
    inconsistent = certify_exactly(LCP([[0.0]], [-1.0]), np.array([1.0]))
    assert not inconsistent.solves
    assert inconsistent.x is None
    with pytest.raises(ValueError, match=r"^x: there is no exact point"):
        _ = inconsistent.x_rounded


def test_a_residual_of_one_unit_in_the_last_place_is_told_from_zero():
    """0.1 + 0.2 - 0.3 is not zero in floats: the exact x is not 1, and says so."""
    certificate = certify_exactly(LCP([[0.1]], [-0.3]), np.array([3.0]))
    assert certificate.solves
    assert certificate.x == (Fraction(0.3) / Fraction(0.1),)
    assert certificate.x != (Fraction(3),)


def test_exact_certificate_on_a_singular_active_set():
    """Rank-deficient positive semidefinite matrix with an active set that is singular: the float values fix x."""
    B = np.array([[1.0, 1.0, 2.0]])
    problem = LCP(B.T @ B, -B[0] * 4.0)
    certificate = certify_exactly(problem, np.array([0.7, 0.3, 1.5]))
    assert certificate.solves
    assert all(value > 0 for value in certificate.x)
    assert sum(a * b for a, b in zip((1, 1, 2), certificate.x)) == 4


def test_exact_certificate_of_random_floats_at_order_forty():
    rng = np.random.default_rng(0)
    n = 40
    A = rng.standard_normal((n, n))
    x = np.maximum(rng.standard_normal(n), 0.0)
    problem = LCP(A, np.where(x > 0, 0.0, 1.0) - A @ x)
    certificate = certify_exactly(problem, x)
    assert certificate.solves
    np.testing.assert_allclose(certificate.x_rounded, x, atol=1e-11)
    assert max(value.denominator.bit_length() for value in certificate.x) > 500


def test_large_problem_with_a_small_active_set_and_a_refusal():
    n = 2000
    A = sp.diags_array([-np.ones(n - 1), 3.0 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
    q = np.ones(n)
    q[:3] = -1.0
    x = np.zeros(n)
    x[:3] = np.linalg.solve(A.toarray()[:3, :3], [1.0, 1.0, 1.0])
    certificate = certify_exactly(LCP(A, q), x)
    assert certificate.solves
    assert certificate.active == (0, 1, 2)
    with pytest.raises(ValueError, match=r"^x: expected an active set of at most"):
        certify_exactly(LCP(A, -q), np.ones(n))


@given(st.data(), st.integers(1, 3), st.booleans())
@settings(deadline=None, max_examples=150)
def test_farkas_against_exact_truth(data, n, sparse):
    A = data.draw(arrays(np.int64, (n, n), elements=SMALL))
    q = data.draw(arrays(np.int64, n, elements=SMALL))
    problem = dense_or_sparse(A, q, sparse)
    proof = farkas(problem)
    assert (proof is None) == has_feasible_point(A, q)
    if proof is not None:
        assert proof.no_feasible_point
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
    assert proof.no_feasible_point
    check_farkas(problem, proof)


@pytest.mark.parametrize("sparse", [False, True])
def test_farkas_whose_columns_are_all_tight(sparse):
    """Columns of both signs force A'y = 0, so y = (b, a) up to a factor: no rounding of floats is exact."""
    a, b = 912_345_678_901, 702_345_678_907
    problem = dense_or_sparse([[a, -a], [-b, b]], [-1.0, 1.0 / 3.0], sparse)
    proof = farkas(problem)
    assert proof.no_feasible_point
    check_farkas(problem, proof)
    assert proof.y == (b, a)


def test_random_float_multiplier():
    """Half the rows of a random matrix made negative: emptiness is proved for floats at n = 60."""
    rng = np.random.default_rng(5)
    n = 60
    A = rng.standard_normal((n, n))
    A[0] = -A[1:5].sum(axis=0) - rng.random(n)
    problem = LCP(A, np.where(np.arange(n) < 5, -1.0, 1.0))
    proof = farkas(problem)
    assert proof.no_feasible_point
    check_farkas(problem, proof)


def test_no_multiplier_where_points_are_feasible():
    for item in (*EXAMPLES, *COUNTEREXAMPLES):
        assert farkas(item.problem) is None


def test_a_huge_x_excuses_no_residual():
    # Found by the random check against enumeration: the rounding of x3 = 1.5e17 must not excuse w3 = -5.
    problem = LCP([[0, -1, 0], [3, 0, 0], [0, -2, 0]], [3.0, -3.0, 1.0])
    assert not certify(problem, np.array([1.0, 3.0, 1.5e17])).solves()


def test_a_solution_that_falls_off_below_the_smallest_number_is_one():
    n, e = 90, 1e-4
    A = sp.diags_array([np.full(n - 1, -e), np.full(n, 1.0 + 2.0 * e), np.full(n - 1, -e)], offsets=[-1, 0, 1])
    q = np.zeros(n)
    q[0] = -1.0
    found = solve(LCP(A, q))
    assert found.outcome is Outcome.SOLVED
    # What is small because everything is is judged as before.
    assert certify(LCP(A, 1e-300 * q), np.zeros(n)).relative_residual == 1.0
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
