"""`lcp.solutions`: all solutions where faces are tried, most of them by paths."""

from __future__ import annotations

import numpy as np
import pytest

from continuation.budget import Budget
from problems.lcp import LCP, MixedLCP, solutions, solve_by_enumeration


def coordination(m):
    C = 2.0 - np.eye(m) + 1e-3 * np.random.default_rng(m).random((m, m))
    nothing = np.zeros((m, m))
    return LCP(np.block([[nothing, C], [C, nothing]]), -np.ones(2 * m))


@pytest.mark.parametrize("m", [3, 4])
def test_all_equilibria_of_coordination_games_by_paths_from_one(m):
    found = solutions(coordination(m), enumerate_faces=False)
    assert len(found) == 2**m - 1
    assert not found.complete
    assert max(one.residual for one in found) <= 1e-14
    sums = np.sort(found.points.sum(axis=1))
    assert np.array_equal(found.points, solutions(coordination(m), enumerate_faces=False).points)
    assert sums[0] < sums[-1]


def test_faces_give_all_and_paths_the_same():
    for seed in range(8):
        random = np.random.default_rng([6, seed])
        problem = LCP(random.normal(size=(6, 6)), random.normal(size=6))
        tried = solutions(problem)
        assert tried.complete
        assert len(tried) == len(solve_by_enumeration(problem).solutions)
        followed = solutions(problem, enumerate_faces=False)
        assert {tuple(x) for x in followed.points.round(9)} <= {tuple(x) for x in tried.points.round(9)}


def test_a_continuum_is_not_complete():
    found = solutions(LCP([[1.0, 1.0], [1.0, 1.0]], [-1.0, -1.0]))
    assert not found.complete
    assert "continuum" in found.message


def test_with_bounds():
    # min -x'x / 2 on a square: nine stationary points.
    found = solutions(MixedLCP(-np.eye(2), [0.1, 0.2], -1.0, 1.0))
    assert len(found) == 9


def test_a_budget():
    assert len(solutions(coordination(3), enumerate_faces=False, budget=Budget(steps=1))) < 7


def test_no_solution():
    assert len(solutions(LCP([[0.0]], [-1.0]))) == 0
    assert solutions(LCP([[0.0]], [-1.0])).complete
    assert not solutions(LCP([[0.0]], [-1.0]), enumerate_faces=False).complete
