"""Phase I: a point of F = {x > 0, A x + q > 0}, or the exact proof that F is empty, against exact truth."""

from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from problems.lcp import LCP
from problems.lcp.proof.phase1 import NoStrictlyFeasiblePoint, is_strictly_feasible, strictly_feasible_start

from ....exact import exact_w

SMALL = st.integers(-2, 2)


def check_start(problem, x0):
    assert min(x0) > 0
    assert min(exact_w(problem, x0)) > 0


def interior_is_empty(A, q):
    """Fourier and Motzkin's elimination in integers: strict inequalities a.x + b > 0, all of them, exactly."""
    n = len(q)
    system = {tuple([int(i == j) for j in range(n)] + [0]) for i in range(n)}
    system |= {tuple([int(v) for v in row] + [int(b)]) for row, b in zip(A, q)}
    for j in range(n):
        positive = [row for row in system if row[j] > 0]
        negative = [row for row in system if row[j] < 0]
        system = {row for row in system if row[j] == 0}
        system |= {tuple(-low[j] * a + up[j] * b for a, b in zip(up, low)) for up in positive for low in negative}
    return any(row[-1] <= 0 for row in system)


@given(st.data(), st.integers(1, 3), st.booleans())
@settings(deadline=None, max_examples=150)
def test_start_or_proof_against_exact_truth(data, n, sparse):
    A = data.draw(arrays(np.int64, (n, n), elements=SMALL))
    q = data.draw(arrays(np.int64, n, elements=SMALL))
    problem = LCP(sp.csr_array(A) if sparse else A, q)
    if interior_is_empty(A, q):
        with pytest.raises(NoStrictlyFeasiblePoint):
            strictly_feasible_start(problem)
    else:
        check_start(problem, strictly_feasible_start(problem))


@pytest.mark.parametrize("seed", range(5))
def test_rows_and_columns_over_sixteen_orders_of_magnitude(seed):
    rng = np.random.default_rng(seed)
    n = 12
    A = rng.standard_normal((n, n))
    q = 1.0 - A @ rng.uniform(0.5, 1.5, n)
    rows, columns = 10.0 ** rng.uniform(-8, 8, n), 10.0 ** rng.uniform(-8, 8, n)
    problem = LCP(rows[:, None] * A * columns, rows * q)
    check_start(problem, strictly_feasible_start(problem))


def test_infeasible_is_told_from_no_interior():
    with pytest.raises(NoStrictlyFeasiblePoint, match="no solution") as caught:
        strictly_feasible_start(LCP([[-1.0, 0.0], [0.0, 1.0]], [-1.0, -10.0]))
    assert caught.value.certificate.gap < 0
    with pytest.raises(NoStrictlyFeasiblePoint, match="need not be feasible") as caught:
        strictly_feasible_start(LCP([[1.0, -1.0], [-1.0, 1.0]], [0.0, 0.0]))
    assert caught.value.certificate is None


def test_boundary_points_are_not_strictly_feasible():
    """The exact value of 0.1 * 3 - 0.3 in floats, 2.8e-17, decides, not the rounded one."""
    problem = LCP([[0.1]], [-0.3])
    for x in (np.array([3.0]), np.nextafter(np.array([3.0]), 0.0)):
        truth = Fraction(0.1) * Fraction(x[0]) - Fraction(0.3)
        assert is_strictly_feasible(problem, x) == (truth > 0)
    assert not is_strictly_feasible(LCP([[1.0]], [-1.0]), np.array([1.0]))
