"""What takes many pivots: games with long paths from the first labels, traffic with more than a thousand unknowns."""

from __future__ import annotations

import numpy as np

from problems.lcp import LCP, solve
from problems.lcp.pivoting.almost import Ended
from problems.lcp.pivoting.starts import Game
from tests.util import benchmark

HARD = benchmark("outside.py")


def test_they_are_followed_on_before_any_path():
    m, rho = 100, -0.9
    X, Y = np.random.default_rng([77, 1]).standard_normal((2, m, m))
    Y = rho * X + np.sqrt(1.0 - rho * rho) * Y
    problem = LCP(np.block([[0.0 * X, X - X.min() + 1.0], [(Y - Y.min() + 1.0).T, 0.0 * X]]), -np.ones(2 * m))
    assert Game.of(problem).path(0).run(10 * problem.n) is Ended.PIVOTS
    found = solve(problem)
    assert found.solved
    assert not found.paths
    assert "Lemke and Howson" in found.message


def test_traffic_with_more_than_a_thousand_unknowns_is_pivoted():
    found = solve(HARD.traffic(12, np.random.default_rng(0)))
    assert (found.problem.n, found.outcome.name, len(found.paths)) == (1188, "SOLVED", 0)
    assert "Lemke" in found.message
