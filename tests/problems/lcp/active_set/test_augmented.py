"""The augmented Lagrangian of a program: what it is made of, and programs on which active sets alone cycle."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import linprog

from problems import lcp
from problems.lcp import Outcome
from problems.lcp.active_set.augmented import Saddle
from problems.lcp.proof.verdict import to_precision

INF = np.inf


SADDLE = [[2.0, -1.0], [1.0, 0.0]]


@pytest.mark.parametrize(
    ("A", "lower", "upper", "primal", "program"),
    [
        (SADDLE, -INF, INF, 1, True),
        ([[2.0, 1.0], [1.0, 0.0]], -INF, INF, 1, False),
        ([[2.0, -1.0], [1.0, 0.5]], -INF, INF, 1, False),
        (SADDLE, -INF, INF, 0, False),
        (SADDLE, [-INF, 0], [INF, 1], 1, False),
        (SADDLE, [-INF, 1], [INF, INF], 1, False),
    ],
)
def test_what_is_no_program_is_not_read_as_one(A, lower, upper, primal, program):
    assert (Saddle.of(lcp.MixedLCP(A, [0.0, 0.0], lower, upper, primal=primal)) is not None) == program


@pytest.mark.parametrize("sparse", [False, True])
def test_degenerate_linear_programs_need_no_path(sparse):
    """Transport with equal supplies and demands: every vertex is degenerate, and unshifted active sets cycle."""
    rng, k = np.random.default_rng(4), 7
    ones, eye = np.ones((1, k)), np.eye(k)
    rows = np.vstack([np.kron(eye, ones), np.kron(ones, eye)])
    for _ in range(5):
        cost = rng.integers(1, 20, k * k).astype(float)
        given = sp.csr_array(rows) if sparse else rows
        solution = lcp.solve(lcp.from_lp(cost, A_eq=given, b_eq=np.ones(2 * k), lower=0))
        assert solution.success, solution.message
        assert not solution.paths
        assert solution.objective == pytest.approx(linprog(cost, A_eq=rows, b_eq=np.ones(2 * k)).fun, abs=1e-12)


def test_rounding_in_place_of_a_zero_is_solved_to_precision_and_said():
    """A row that asks of variables without a sign change to sum to -1e-17: no x does, and for zeros all do."""
    rng, n = np.random.default_rng(6), 60
    M = rng.standard_normal((n, n))
    G = np.abs(np.vstack([np.append(np.ones(3), np.zeros(n - 3)), rng.standard_normal((10, n))]))
    lower, c, rest = np.append(np.zeros(3), np.full(n - 3, -1.0)), rng.standard_normal(n), 5.0 + rng.random(10)
    for right, outcome in ((-1e-17, Outcome.SOLVED_TO_PRECISION), (0.0, Outcome.SOLVED), (-1e-6, Outcome.UNSOLVABLE)):
        solution = lcp.solve(lcp.from_qp(M @ M.T / n, c, G, np.append(right, rest), lower=lower, upper=1.0))
        assert solution.outcome is outcome
        if outcome is Outcome.SOLVED_TO_PRECISION:
            assert solution.residual <= 1e-14
            assert "the data as given may have none" in solution.message


@pytest.mark.parametrize(("slope", "x", "solved"), [(-1.0, [1e17, 1e17, 0.0], False), (1.0, [0.0, 0.0, 0.0], True)])
def test_a_point_far_along_a_ray_does_not_solve_to_precision(slope, x, solved):
    """The objective falls for ever along (1, 1): relative to x its slope is rounding, relative to q it is not."""
    problem = lcp.from_lp([slope, 0.0], A_eq=[[1.0, -1.0]], b_eq=[0.0], lower=0).problem
    assert problem.relative_residual(np.array(x)) <= 1e-16
    assert to_precision(problem, lcp.certify(problem, np.array(x))) == solved
