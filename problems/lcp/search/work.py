"""The default budget: work, not seconds."""

from __future__ import annotations

from continuation.budget import Budget
from problems.lcp.data.problem import MixedLCP

FACTORIZATIONS = 170_000
"""A minute for a small problem."""

LEAST_WORK = 100
"""About two paths."""


def default_budget(problem: MixedLCP) -> Budget:
    """Factorisations and steps of about one minute.

    CPU milliseconds per factorisation, one thread: dense 0.33 (n = 10) to 80 (1000), within a factor of 2 of 0.35 (1 +
    n^2 / 5000); sparse 6.3 to 180 (n = 900 to 10,000), within a factor of 5 of 0.35 (1 + n / 50).
    """
    size = problem.n / 50.0 if problem.sparse else problem.n**2 / 5000.0
    limit = max(round(FACTORIZATIONS / (1.0 + size)), LEAST_WORK)
    return Budget(steps=limit, factorizations=limit)
