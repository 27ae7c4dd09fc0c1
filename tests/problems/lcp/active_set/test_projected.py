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


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_a_diagonal_matrix_needs_one_step_in_any_units(unit):
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
