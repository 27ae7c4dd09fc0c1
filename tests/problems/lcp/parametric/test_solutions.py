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


CASES = {
    "a continuum": (LCP([[1.0, 1.0], [1.0, 1.0]], [-1.0, -1.0]), {}, (1, 2), False, "continuum"),
    # min -x'x / 2 on a square: nine stationary points.
    "bounds": (MixedLCP(-np.eye(2), [0.1, 0.2], -1.0, 1.0), {}, (9,), False, ""),
    "a budget": (coordination(3), {"enumerate_faces": False, "budget": Budget(steps=1)}, range(7), False, ""),
    "none": (LCP([[0.0]], [-1.0]), {}, (0,), True, ""),
    "none, by paths": (LCP([[0.0]], [-1.0]), {"enumerate_faces": False}, (0,), False, ""),
}


@pytest.mark.parametrize(("problem", "options", "counts", "complete", "said"), CASES.values(), ids=CASES)
def test_so_many_are_found_and_it_is_said_whether_these_are_all(problem, options, counts, complete, said):
    found = solutions(problem, **options)
    assert len(found) in counts
    assert found.complete == complete
    assert said in found.message
