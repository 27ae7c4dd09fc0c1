"""Outcomes: which one is a success, and a solution in one line."""

import numpy as np

from problems import lcp


def test_an_outcome_is_true_exactly_where_a_solution_was_found():
    found = (lcp.Outcome.SOLVED, lcp.Outcome.SOLVED_TO_PRECISION)
    assert [bool(outcome) for outcome in lcp.Outcome] == [outcome in found for outcome in lcp.Outcome]


def test_a_solution_in_one_line():
    solution = lcp.solve(lcp.LCP(np.eye(2), -np.ones(2)))
    assert repr(solution) == "<Solution SOLVED: n = 2, residual 0.0e+00, 0 paths>"


def test_an_exact_solution_is_preferred_to_one_of_other_last_digits():
    # Active sets end within the face of both, whose equations are inconsistent by a digit; x_2 = 0 solves exactly.
    A = [[0.1768198335047411, 0.44183472382140804], [0.44183472382140804, 1.1040499207862082]]
    problem = lcp.LCP(A, [-0.48196594397099524, -1.2043292063163211])
    assert not lcp.certify_exactly(problem, [0.37628023, 0.9402433]).solves
    found = lcp.solve(problem)
    assert found.outcome is lcp.Outcome.SOLVED
    assert found.x[1] == 0.0
    assert lcp.certify_exactly(problem, found.x).solves
