"""What the tests of problems with bounds have in common."""

import numpy as np

from problems.lcp import MixedLCP


def drawn(rng, n):
    """A monotone problem with lower, upper, both and no bounds mixed."""
    M, kind = rng.standard_normal((n, n)), rng.integers(0, 4, n)
    lower = np.where(kind % 2 == 0, rng.standard_normal(n), -np.inf)
    upper = np.where(kind == 1, rng.standard_normal(n), np.where(kind == 2, lower + 0.1 + rng.random(n), np.inf))
    return MixedLCP(M @ M.T / n + np.triu(M, 1) - np.triu(M, 1).T, rng.standard_normal(n), lower, upper)


def stationarity(problem):
    """The problem in (x, z), of order 2n, whose solutions are the stationary points of the gap: see docs/bounds.md."""
    low, high, A = np.isfinite(problem.lower), np.isfinite(problem.upper), problem.A
    end = np.where(low, problem.lower, np.where(high, problem.upper, 0.0))
    width = np.where(low & high, problem.upper - problem.lower, np.inf)
    return MixedLCP(
        np.block([[A + A.T, -A.T], [A, np.zeros_like(A)]]), np.concatenate([problem.q - A.T @ end, problem.q]),
        np.concatenate([problem.lower, np.where(low, 0.0, -np.inf)]),
        np.concatenate([problem.upper, np.where(low, width, np.where(high, 0.0, np.inf))]),
    )  # fmt: skip
