"""Feasibility by pivots: against HiGHS, and where it stands in for it."""

import numpy as np

from problems import lcp
from problems.lcp.proof import farkas
from problems.lcp.proof.feasibility import by_linear_program, by_pivots
from problems.lcp.proof.pieces import doubtful
from problems.lcp.reference.enumeration import exhaust


def test_points_and_multipliers_agree_with_those_of_a_linear_program():
    seen = [0, 0]
    for k in range(60):
        r = np.random.default_rng([26, k])
        m, n = r.integers(1, 13, 2)
        A, q = r.integers(-3, 3, (m, n)).astype(float), r.integers(-3, 2, m).astype(float)
        feasible, y = by_pivots(A, q)
        theirs = by_linear_program(A, q)
        infeasible = theirs is not None and q @ theirs < -1e-9
        assert feasible == (not infeasible)
        seen[feasible] += 1
        if not feasible:
            assert y is not None
            assert y.min() >= 0.0
            assert (A.T @ y).max() <= 1e-12 * y.max()
            assert q @ y < 0.0
    assert min(seen) > 15


def test_no_linear_program_is_solved_where_pivots_tell(monkeypatch):
    monkeypatch.delattr(farkas, "by_linear_program")
    skew = lcp.LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0])
    assert lcp.solve(skew).farkas.holds(skew)
    assert farkas.infeasibility(lcp.LCP([[1.0, -2.0], [-0.1, 1.0]], [1.0, -1.0])) is None


def test_a_small_problem_without_solution_needs_no_units():
    # Feasible at x = (0, 1), where w = (0, 2), but no face holds a solution.
    problem = lcp.LCP([[-1.0, 1.0], [-1.0, 1.0]], [-1.0, 1.0])
    assert not exhaust(problem).solvable
    found = lcp.solve(problem)
    assert found.outcome is lcp.Outcome.UNSOLVABLE
    assert found.exhaustion is not None
    assert not found.paths


def test_signs_alone_exclude_singular_faces():
    # On the face of both w_0 = 2 x_0 + 3 > 0; on that of x_1 alone w_0 = 3, and w_1 = -1 on every one.
    problem = lcp.LCP([[2.0, 0.0], [-1.0, 0.0]], [3.0, -1.0])
    states = np.array([[0, 0], [0, -1], [-1, 0], [-1, -1]], dtype=np.int8)
    assert not doubtful(problem, states).any()
    # One with w_1 = x_0 - x_1 is left, singular or not.
    assert doubtful(lcp.LCP([[1.0, -1.0], [1.0, -1.0]], [0.0, 0.0]), states).all()
