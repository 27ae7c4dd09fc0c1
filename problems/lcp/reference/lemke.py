"""Lemke's method: complementary pivots from a covering vector, with the lexicographic rule against cycling."""

from __future__ import annotations

import numpy as np

from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.almost import Ended
from problems.lcp.pivoting.starts import covering
from problems.lcp.reference.newton import solved_on
from problems.lcp.reference.result import ReferenceResult, at_point, without_point


def lemke(problem: LCP) -> ReferenceResult:
    """Solve LCP(q, A) by Lemke's method alone, with the covering vector of ones: the pivots that `solve` tries too.

    Among rows of equal ratio the lexicographically least row leaves, so that no basis comes back and the method ends:
    at a solution, or on a secondary ray. Dense; O(n^2) a pivot, at most 50 n + 100 of them.

    Parameters
    ----------
    problem : LCP
        A sparse A is made dense.

    Returns
    -------
    ReferenceResult

    References
    ----------
    Lemke 1965; Cottle, Pang and Stone, Algorithm 4.4.5 and section 4.9 (lexicographic rule).
    """
    path, budget = covering(problem, np.ones(problem.n)), 50 * problem.n + 100
    ended = None if path is None else path.run(budget)
    if path is None or ended is Ended.PIVOTS:
        return without_point(budget, 0, f"No solution within {budget} pivots.")
    if ended is not Ended.REACHED:
        return without_point(path.pivots, 0, f"Ended on a secondary ray after {path.pivots} pivots.")
    points = (path.values(), solved_on(problem, path.active, np.where(path.active, -problem.q, 0.0)))
    x = min(points, key=problem.natural_residual)
    return at_point(problem, x, path.pivots, 1, "The last basis is too ill-conditioned for the residual test.")
