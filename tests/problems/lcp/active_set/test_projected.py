"""The guess of an active set by projected gradients: right where that is easy, and worth its cost elsewhere."""

import numpy as np
import pytest

from problems import lcp
from problems.lcp.active_set.projected import projected_state
from problems.lcp.data.problem import BETWEEN, LOWER, UPPER


def random_data(kind, n, seed):
    """P, c and the two bounds of a program in the box [-1, 1]^n."""
    rng = np.random.default_rng(seed)
    if kind == "condition 1e6":
        Q, _ = np.linalg.qr(rng.standard_normal((n, n)))
        P = (Q * np.logspace(0, -6, n)) @ Q.T
    else:
        M = rng.standard_normal((n // 2 if kind == "rank n/2" else n, n))
        P = M.T @ M / n + (0.1 * np.eye(n) if kind == "definite" else 0.0)
    return (P + P.T) / 2, rng.standard_normal(n), -np.ones(n), np.ones(n)


def test_a_diagonal_matrix_needs_one_step_in_any_units():
    for unit in (1e-6, 1.0, 1e6):
        problem = lcp.MixedLCP(np.diag([2.0, 3.0, 5.0]) / unit, [-20.0, 3.0, 50.0], -2 * unit, 4 * unit)
        np.testing.assert_array_equal(projected_state(problem), [UPPER, BETWEEN, LOWER])


@pytest.mark.parametrize(("kind", "counted"), [("rank n/2", 10), ("definite", 8), ("condition 1e6", 6)])
def test_few_corrections_are_left(kind, counted):
    """Of five programs together."""
    data = [random_data(kind, 100, seed) for seed in range(5)]
    found = [lcp.solve(lcp.from_qp(P, c, lower=low, upper=high)) for P, c, low, high in data]
    assert all(solution.success for solution in found)
    assert max(solution.certificate.relative_residual for solution in found) <= 1e-14
    assert sum(solution.counts.factorizations for solution in found) == counted


@pytest.mark.parametrize("diagonal", [0.0, 1.0])
def test_directions_without_curvature_are_no_trouble(diagonal):
    A = np.array([[diagonal, 1.0], [1.0, diagonal]])
    problem = lcp.MixedLCP(A, [-1.0, 2.0], [-1.0, -np.inf], [np.inf, 5.0])
    assert projected_state(problem).shape == (2,)
    boxed = lcp.solve(lcp.MixedLCP(A, [-1.0, 2.0], -1.0, 5.0))
    assert boxed.success


def test_a_matrix_of_a_program_is_not_copied_twice_and_that_of_the_caller_is():
    P = np.eye(3)
    program = lcp.from_qp(P, [1.0, 2.0, 3.0], lower=0)
    assert program.problem.A is program.P
    assert not program.P.flags.writeable
    P[0, 0] = 7.0
    assert program.P[0, 0] == 1.0
