"""Lemke's method: complementary pivots from a covering vector, with the lexicographic rule against cycling."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.reference.result import ReferenceResult, at_point, without_point

_TIE = 1e-11
"""Ratios closer than this, relatively, count as tied; smaller pivots, relative to their column, count as zero."""


def lemke(problem: LCP) -> ReferenceResult:
    """Solve LCP(q, A) by Lemke's method, with the covering vector of ones.

    The tableau holds w - A x - e z0 = q. Among rows of equal ratio the lexicographically least row of
    [q, B^-1] leaves (z0 itself if it is tied), so that no basis comes back and the method ends: with z0 = 0
    and a solution, or on a secondary ray. Dense; O(n^2) a pivot, at most 50 n + 100 of them.

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
    n = problem.n
    if (problem.q >= 0).all():
        return at_point(problem, np.zeros(n), 0, 0, "")
    budget, dense = 50 * n + 100, problem.A.toarray() if problem.sparse else problem.A
    # Columns: w (0..n-1, which are B^-1 throughout), x (n..2n-1), z0 (2n), right-hand side (2n+1).
    tableau = np.hstack([np.eye(n), -dense, -np.ones((n, 1)), problem.q[:, None]])
    z0, basis = 2 * n, np.arange(n)
    # Afterwards every row of [q, B^-1] is lexicographically positive.
    row: int | None = _lexicographic_least(_lexicographic_rows(tableau, basis), np.ones(n))
    entering = z0
    for pivots in range(1, budget + 1):
        assert row is not None
        leaving = int(basis[row])
        _pivot(tableau, row, entering)
        basis[row] = entering
        if leaving == z0:
            x = _solution(problem, dense, tableau, basis)
            return at_point(problem, x, pivots, 1, "The last basis is too ill-conditioned for the residual test.")
        entering = leaving + n if leaving < n else leaving - n
        row = _leaving_row(tableau, basis, entering, z0)
        if row is None:
            return without_point(pivots, 0, f"Ended on a secondary ray after {pivots} pivots.")
    return without_point(budget, 0, f"No solution within {budget} pivots.")


def _lexicographic_least(rows: Array, scale: Array) -> int:
    """The index of the lexicographically least of rows / scale, columns compared one by one within `_TIE`."""
    tied = np.arange(rows.shape[0])
    for column in rows.T:
        if tied.size == 1:
            break
        ratio = column[tied] / scale[tied]
        least = ratio.min()
        tied = tied[ratio <= least + _TIE * (1.0 + abs(least))]
    return int(tied[0])


def _lexicographic_rows(tableau: Array, candidates: NDArray[np.intp]) -> Array:
    n = tableau.shape[0]
    return np.hstack([tableau[candidates, -1:], tableau[candidates, :n]])


def _leaving_row(tableau: Array, basis: NDArray[np.intp], entering: int, z0: int) -> int | None:
    """The row that blocks the entering column, or None if none does: a ray."""
    column = tableau[:, entering]
    candidates = np.flatnonzero(column > _TIE * max(1.0, float(np.abs(column).max())))
    if candidates.size == 0:
        return None
    ratio = tableau[candidates, -1] / column[candidates]
    tied = candidates[ratio <= ratio.min() + _TIE * (1.0 + abs(ratio.min()))]
    of_z0 = tied[basis[tied] == z0]
    if of_z0.size:
        return int(of_z0[0])
    return int(tied[_lexicographic_least(_lexicographic_rows(tableau, tied), column[tied])])


def _pivot(tableau: Array, row: int, column: int) -> None:
    tableau[row] /= tableau[row, column]
    factors = tableau[:, column].copy()
    factors[row] = 0.0
    tableau -= np.outer(factors, tableau[row])
    tableau[:, column] = 0.0
    tableau[row, column] = 1.0


def _solution(problem: LCP, dense: Array, tableau: Array, basis: NDArray[np.intp]) -> Array:
    """X of the last basis: solved afresh from the data where that is more exact than the pivoted tableau."""
    n = problem.n
    x = np.zeros(n)
    of_x = basis >= n
    x[basis[of_x] - n] = tableau[of_x, -1]
    active = np.sort(basis[of_x] - n)
    fresh = np.zeros(n)
    factors, swaps, info = scipy.linalg.lapack.dgetrf(dense[np.ix_(active, active)]) if active.size else (None, None, 1)
    if info == 0:
        fresh[active], _ = scipy.linalg.lapack.dgetrs(factors, swaps, -problem.q[active])
    better = bool(np.isfinite(fresh).all()) and problem.natural_residual(fresh) < problem.natural_residual(x)
    return fresh if better else x
