"""The default budget: work, not seconds, so that no clock decides an answer."""

from __future__ import annotations

from functools import lru_cache

from continuation.budget import Budget
from problems.lcp.data.problem import MixedLCP

FACTORIZATIONS = 170_000
"""About one minute for a small problem."""

LEAST_WORK = 100
"""About two paths."""


def default_budget(problem: MixedLCP) -> Budget:
    """Factorisations, and steps, of about one minute; at least `LEAST_WORK`.

    Measured CPU milliseconds per factorisation of whole searches, one thread. Dense, n = 10, 50, 100, 200, 300, 500,
    1000: 0.33, 0.46, 0.71, 2.9, 5.4, 17, 80: 0.35 (1 + n^2 / 5000) within a factor of 2. Sparse: 6.3 (tridiagonal, n =
    1000), 17 (n = 10,000), 6.4 (grid, n = 900), 180 (n = 10,000), 38 (random, n = 1000): 0.35 (1 + n / 50) within a
    factor of 5.
    """
    size = problem.n / 50.0 if problem.sparse else problem.n**2 / 5000.0
    return _budget(max(round(FACTORIZATIONS / (1.0 + size)), LEAST_WORK))


@lru_cache(maxsize=32)
def _budget(limit: int) -> Budget:
    return Budget(steps=limit, factorizations=limit)
