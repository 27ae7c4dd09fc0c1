"""How much a search may cost: work, not seconds, so that no clock decides an answer."""

from __future__ import annotations

from functools import lru_cache

from continuation.budget import Budget
from problems.lcp.data.problem import MixedLCP

FACTORIZATIONS = 170_000
"""About a minute's for a small problem."""

LEAST_WORK = 100
"""About two paths."""


def default_budget(problem: MixedLCP) -> Budget:
    """As many factorisations, and steps, as a search takes in about a minute; at least a hundred.

    Measured in processor time, one thread, over everything that a search does, in milliseconds a factorisation: dense
    problems of order 10, 50, 100, 200, 300, 500 and 1000 took 0.33, 0.46, 0.71, 2.9, 5.4, 17 and 80, which is
    0.35 (1 + n^2 / 5000) within a factor of 2. Sparse ones took 6.3 (tridiagonal, n = 1000), 17 (n = 10,000),
    6.4 (a grid, n = 900), 180 (n = 10,000) and 38 (random, n = 1000), which is 0.35 (1 + n / 50) within a factor of 5.
    """
    size = problem.n / 50.0 if problem.sparse else problem.n**2 / 5000.0
    return _budget(max(round(FACTORIZATIONS / (1.0 + size)), LEAST_WORK))


@lru_cache(maxsize=32)
def _budget(limit: int) -> Budget:
    return Budget(steps=limit, factorizations=limit)
