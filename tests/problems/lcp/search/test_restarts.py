"""Restarts: reproducible, and given up when they are not worth following."""

import math

import numpy as np
import pytest

import continuation
from problems import lcp
from problems.lcp.homotopies.starts import LOG_DEVIATION, START_DISTANCES, typical_units

PLANTED = 30


def planted(seed, n=PLANTED):
    """A random problem that is neither monotone nor P, with a solution."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((n, n)) / np.sqrt(n)
    x = np.maximum(rng.standard_normal(n), 0.0)
    w = np.where(x == 0.0, np.abs(rng.standard_normal(n)), 0.0)
    return lcp.LCP(A, w - A @ x)


@pytest.mark.parametrize("seed", range(20))
def test_starts_are_centred_positive_and_at_their_distance(seed):
    problem = planted(1)
    start = lcp.random_start(problem, np.random.default_rng(seed))
    assert min(a.min() for a in (start.x0, start.z1, start.z2, start.w0)) > 0.0
    first, second = start.x0 * start.z1, start.w0 * start.z2
    np.testing.assert_allclose(first, first[0], rtol=1e-12)
    np.testing.assert_allclose(second, second[0], rtol=1e-12)
    x, w = typical_units(problem)
    scale, (low, high) = np.sqrt(first[0] / (2.0 * x * w)), START_DISTANCES
    assert 10**low <= scale <= 10**high
    assert 0.5 * LOG_DEVIATION <= np.log(start.x0 / (2.0 * scale * x)).std() <= 1.5 * LOG_DEVIATION
    # Where the two products are equal a central point of the LCP is one of the path.
    assert 0.4 <= second[0] / first[0] <= 2.5


def test_restarts_are_the_same_again_and_depend_on_the_seed():
    problem = next(p for p in map(planted, range(50)) if not lcp.solve(p, "kkt", restarts=0).solved)
    first, again, other = (lcp.solve(problem, "kkt", restarts=300, seed=seed) for seed in (5, 5, 6))
    for found in (first, again):
        assert lcp.certify(problem, found.x).solves(1e-10)
        np.testing.assert_array_equal(found.x, first.x)
        assert len(found.paths) == len(first.paths)
        assert f"random start {len(found.paths) - 1} (seed 5)" in found.message
        assert found.path is found.paths[-1]
    assert all(len(path) <= 2 for path in first.paths[1:-1])
    assert not np.array_equal(other.paths[1].steps[0].u, first.paths[1].steps[0].u)


def test_restarts_end_at_their_count():
    solution = lcp.solve(lcp.LCP([[0.0, 1.0], [0.0, 0.0]], [-1.0, 1.0]), "kkt", restarts=5)
    assert solution.outcome is lcp.Outcome.STATIONARY
    assert len(solution.paths) == 6
    assert "Restarts from random starts: 5" in solution.message


def test_restarts_go_on_until_the_budget_is_used_up(monkeypatch):
    """Whatever it is; where it has no limit there is one to their number."""
    monkeypatch.setattr("problems.lcp.search.solver.MOST_RESTARTS", 3)
    A = np.eye(61)
    A[:2, :2] = [[0.0, 1.0], [0.0, 0.0]]
    problem = lcp.LCP(A, np.append([-1.0, 1.0], -np.ones(59)))
    endless = lcp.solve(problem, budget=continuation.Budget(steps=math.inf))
    assert "Restarts from random starts: 3" in endless.message
    assert not endless.solved
    # Active sets come first, and are no part of a path.
    assert 0 < sum(path.counts.factorizations for path in endless.paths) < endless.counts.factorizations
    limit = endless.counts.factorizations + 300
    found = lcp.solve(problem, restarts=1000, budget=continuation.Budget(steps=math.inf, factorizations=limit))
    assert f"The budget is used up: {limit} factorisations." in found.message
    assert limit <= found.counts.factorizations < limit + 200
    assert len(found.paths) > len(endless.paths)
