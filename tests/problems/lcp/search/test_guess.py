"""`solve(problem, guess=solution)`: from the data of a problem nearby to these."""

from __future__ import annotations

import numpy as np
import pytest

from problems.lcp import LCP, MixedLCP, solve


def moving(seed, n=20):
    random = np.random.default_rng(seed)
    M = random.normal(size=(n, n))
    return M @ M.T / n + 0.3 * (M - M.T) + 0.1 * np.eye(n), random.normal(size=n), random


def test_a_problem_nearby_leads_to_the_solution():
    for seed in range(5):
        A, q, random = moving(seed)
        found = solve(LCP(A, q))
        for _ in range(4):
            A, q = A + 1e-3 * random.normal(size=A.shape), q + 0.1 * random.normal(size=q.size)
            found = solve(LCP(A, q), guess=found)
            assert found.solved
            assert "nearby" in found.message
            assert found.x == pytest.approx(solve(LCP(A, q)).x, abs=1e-11)


def test_with_bounds_and_units():
    A, q, random = moving(7)
    units = 10.0 ** random.uniform(-4, 4, q.size)
    lower, upper = np.where(np.arange(20) % 3, -0.5, -np.inf), np.where(np.arange(20) % 4, 0.5, np.inf)
    lower[5] = upper[5] = 0.1
    data = A * units[:, None], lower, upper
    found = solve(MixedLCP(data[0], units * q, lower, upper))
    after = MixedLCP(data[0], units * (q + 0.1 * random.normal(size=20)), lower, upper)
    again = solve(after, guess=found)
    assert "nearby" in again.message
    assert again.x == pytest.approx(solve(after).x, abs=1e-10)


def test_the_path_from_the_nearby_problem_is_followed_up_to_the_largest_table(monkeypatch):
    A, q, random = moving(9)
    found, problem = solve(LCP(A, q)), LCP(A, q + random.normal(size=20))
    for largest, nearby in ((20, True), (19, False)):
        monkeypatch.setattr("problems.lcp.search.pivots.LARGEST_TABLE", largest)
        assert ("nearby" in solve(problem, guess=found).message) is nearby


def test_a_far_guess_harms_nothing():
    for seed in range(5):
        A, q, random = moving(seed, 6)
        far = solve(LCP(np.eye(6), random.normal(size=6)))
        assert solve(LCP(A, q), guess=far).x == pytest.approx(solve(LCP(A, q)).x, abs=1e-11)
