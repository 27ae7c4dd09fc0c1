"""Damped min-Newton: Newton's method on the piecewise linear equation min(x, A x + q) = 0."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import lsmr

from continuation.arrays import Array
from continuation.linear.superlu import factor_superlu
from problems.lcp.data.problem import LCP
from problems.lcp.reference.result import ReferenceResult, at_point, is_solved

_DECREASE = 2e-4
"""Twice Armijo's 1e-4 (Nocedal and Wright, 2006, p. 33), as the merit |min(x, w)|^2 is a square: factor 1 - 2e-4 t."""
_SHORTEST = 1e-10
"""Shortest step of the line search: below it the merit changes by round-off only."""


MIN_NEWTON_ITERATIONS = 300
"""At most: from zero it takes some ten where it arrives."""


def min_newton(problem: LCP) -> ReferenceResult:
    """Solve LCP(q, A) by a damped min-Newton, the primal-dual active-set method with a line search.

    The active set at x is {x_i > w_i}; the step moves to x with w = 0 there and x = 0 elsewhere. A singular
    system is replaced by its least-squares solution. If no step reduces the merit, the full step is taken.

    Parameters
    ----------
    problem : LCP
        It is solved from zero, as the paper's examples 2 to 8 can be.

    References
    ----------
    Pang, Newton's method for B-differentiable equations, Math. Oper. Res. 15, 1990; Hintermueller, Ito and
    Kunisch, SIAM J. Optim. 13, 2003.
    """
    x = np.zeros(problem.n)
    for iteration in range(MIN_NEWTON_ITERATIONS):
        w = problem.w(x)
        trial = _line_search(problem, x, solved_on(problem, x > w, -np.minimum(x, w)))
        # A point that passes is polished until it gets no better: with the right active set one step is exact.
        if is_solved(problem, x) and problem.natural_residual(trial) >= problem.natural_residual(x):
            return at_point(problem, x, iteration, iteration + 1, "")
        x = trial
    most = MIN_NEWTON_ITERATIONS
    return at_point(problem, x, most, most, f"No convergence within {most} iterations.")


def solved_on(problem: LCP, active: NDArray[np.bool_], right: Array) -> Array:
    """Solve J d = right, row i of J being row i of A where active and of I elsewhere; least squares if singular."""
    if problem.sparse:
        J = sp.csc_array(sp.diags_array(active * 1.0) @ problem.A + sp.diags_array(~active * 1.0))
        factored = factor_superlu(J)
        return np.asarray(lsmr(J, right, atol=1e-14, btol=1e-14)[0]) if factored is None else factored.solve(right)
    dense = np.where(active[:, None], problem.A, np.eye(problem.n))
    try:
        return np.asarray(np.linalg.solve(dense, right))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(dense, right, rcond=None)[0])


def _line_search(problem: LCP, x: Array, step: Array) -> Array:
    """The first of x + step, x + step/2, ... that decreases the merit enough, else x + step."""

    def merit(point: Array) -> float:
        residual = np.minimum(point, problem.w(point))
        return float(residual @ residual)

    start = merit(x)
    t = 1.0
    while t > _SHORTEST:
        trial: Array = x + t * step
        if merit(trial) <= (1.0 - _DECREASE * t) * start:
            return trial
        t /= 2.0
    return x + step
