"""What the tests of problems with bounds have in common."""

import numpy as np

from problems.lcp import MixedLCP

INF = np.inf
MONOTONE = np.array([[2.0, 1.0, 0.0, 0.0], [-1.0, 1.0, 0.5, 0.0], [0.0, -0.5, 3.0, 1.0], [0.0, 0.0, -1.0, 0.0]])
EVERY_KIND = MixedLCP(MONOTONE, [-1.0, 2.0, -6.0, 0.5], [0.0, -INF, -1.0, -INF], [INF, 1.0, 1.0, INF])
"""One unknown of each kind: a lower bound, an upper one, both, none."""


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
