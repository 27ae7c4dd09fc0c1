"""What floats with error bounds exclude holds no solution in exact arithmetic, and they exclude nearly all of it."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings

from problems import lcp
from problems.lcp.mixed_strategies import mixed_lcps
from problems.lcp.proof.pieces import doubtful, in_doubt
from problems.lcp.reference.enumeration import exhaust


@settings(max_examples=50, deadline=None)
@given(mixed_lcps())
def test_no_solution_is_excluded(problem):
    assert exhaust(problem, filtered=True) == exhaust(problem)


@pytest.mark.parametrize("power", [-320, -150, 150, 300])
def test_the_ends_of_the_range_of_floats_are_in_doubt_or_right(power):
    rng = np.random.default_rng(12)
    for _ in range(20):
        A, q = rng.integers(-3, 4, (3, 3)).astype(float), rng.integers(-3, 4, 3).astype(float)
        problem = lcp.LCP(A * 10.0 ** (power / 2), q * 10.0**power)
        assert exhaust(problem, filtered=True) == exhaust(problem), problem


def test_a_sign_that_rounding_may_change_is_in_doubt():
    """w_1 is zero exactly on the face of x_0, and a bit below it where q_1 is."""
    A = np.array([[3.0, 0.0], [1.0, 1.0]])
    for q, wrong in (([-1.0, -1.0 / 3.0], False), ([-1.0, -0.34], True)):
        problem = lcp.LCP(A, q)
        asked = doubtful(problem, np.array([[0, -1]], dtype=np.int8))
        assert asked.tolist() == [not wrong]
        assert doubtful(lcp.LCP(sp.csr_array(A), q), np.array([[0, -1]], dtype=np.int8)).tolist() == [not wrong]


def test_nearly_all_faces_of_a_regular_problem_are_excluded():
    rng = np.random.default_rng(13)
    states = np.array(np.meshgrid(*[[-1, 0]] * 8)).reshape(8, -1).T.astype(np.int8)
    for _ in range(5):
        problem = lcp.LCP(rng.standard_normal((8, 8)), rng.standard_normal(8))
        assert doubtful(problem, states).sum() <= 8


def test_a_solution_below_the_least_float_is_not_excluded():
    A, x = np.array([[-6.0, 8.0, 7.0], [2.0, 2.0, 6.0], [-6.0, -4.0, -4.0]]), np.array([3.0, 1.0, 6.0])
    with np.errstate(all="ignore"):
        # x 2^-1078 solves it, and the products by which that is found underflow.
        assert in_doubt(np.ldexp(A, 72), np.ldexp(-A @ x, -1006), np.zeros((1, 3), dtype=np.int8)).all()


def test_signs_alone_exclude_singular_faces():
    # On the face of both w_0 = 2 x_0 + 3 > 0; on that of x_1 alone w_0 = 3, and w_1 = -1 on every one.
    problem = lcp.LCP([[2.0, 0.0], [-1.0, 0.0]], [3.0, -1.0])
    states = np.array([[0, 0], [0, -1], [-1, 0], [-1, -1]], dtype=np.int8)
    assert not doubtful(problem, states).any()
    # One with w_1 = x_0 - x_1 is left, singular or not.
    assert doubtful(lcp.LCP([[1.0, -1.0], [1.0, -1.0]], [0.0, 0.0]), states).all()
