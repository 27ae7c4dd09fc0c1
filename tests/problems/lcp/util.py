"""What several tests of LCPs have in common."""

import numpy as np

from problems import lcp
from problems.lcp import MixedLCP, Outcome


def powers(rng, n, largest):
    """Units that are powers of two."""
    return 2.0 ** rng.integers(-largest, largest + 1, n)


def solution_of(problem, *homotopy, outcome=Outcome.SOLVED, **options):
    """A problem's solution, whose outcome is as expected."""
    solution = lcp.solve(problem, *homotopy, **options)
    assert solution.outcome is outcome, solution.message
    return solution


def x_at_end(problem, path):
    return np.maximum(path.endpoint.y[: problem.n], 0.0)


def drawn(rng, n):
    """A monotone problem with lower, upper, both and no bounds mixed."""
    M, kind = rng.standard_normal((n, n)), rng.integers(0, 4, n)
    lower = np.where(kind % 2 == 0, rng.standard_normal(n), -np.inf)
    upper = np.where(kind == 1, rng.standard_normal(n), np.where(kind == 2, lower + 0.1 + rng.random(n), np.inf))
    return MixedLCP(M @ M.T / n + np.triu(M, 1) - np.triu(M, 1).T, rng.standard_normal(n), lower, upper)


def on_face(problem, active):
    """The point with w = 0 on the active set and x = 0 off it."""
    x, inside = np.zeros(problem.n), np.flatnonzero(active)
    x[inside] = np.linalg.solve(problem.A[np.ix_(inside, inside)], -problem.q[inside])
    return x
