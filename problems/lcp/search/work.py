"""The default budget: work, not seconds."""

from __future__ import annotations

from functools import lru_cache

from continuation.budget import Budget
from problems.lcp.data.problem import MixedLCP

FACTORIZATIONS = 170_000
"""A minute for a small problem."""

LEAST_WORK = 100
"""About two paths."""


def default_budget(problem: MixedLCP) -> Budget:
    """Factorisations, and steps, of about one minute; at least `LEAST_WORK`.

    CPU milliseconds per factorisation, one thread. Dense, n = 10, 50, 100, 200, 300, 500, 1000: 0.33, 0.46, 0.71, 2.9,
    5.4, 17, 80, near 0.35 (1 + n^2 / 5000). Sparse, near 0.35 (1 + n / 50): tridiagonal 6.3 (n = 1000), 17 (10,000);
    grid 6.4 (900), 180 (10,000); random 38 (1000).
    """
    size = problem.n / 50.0 if problem.sparse else problem.n**2 / 5000.0
    return _budget(max(round(FACTORIZATIONS / (1.0 + size)), LEAST_WORK))


@lru_cache(maxsize=32)
def _budget(limit: int) -> Budget:
    return Budget(steps=limit, factorizations=limit)
