"""Published reference methods, on dense matrices.

Each returns x and its number of iterations, or raises ArithmeticError with the reason.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.almost import Ended
from problems.lcp.pivoting.starts import covering

SOLVED_BELOW = 1e-8
"""Largest natural residual of a solution, relative to 1 + |q|_inf; relative to |x| diverging iterates could pass."""

ITERATIONS = 1000
"""Most iterations: convergent runs take some hundred, from zero some ten."""


def is_solved(problem: LCP, x: Array) -> bool:
    """Whether x passes the common test."""
    return problem.natural_residual(x) <= SOLVED_BELOW * (1.0 + float(np.abs(problem.q).max()))


def _dense(problem: LCP) -> Array:
    A: Array = problem.A.toarray() if problem.sparse else problem.A
    return A


def lemke(problem: LCP) -> tuple[Array, int]:
    """Solve LCP(q, A) by Lemke's method with the covering vector of ones; count pivots, at most 50 n + 100.

    The lexicographically least of tied rows leaves, so it ends at a solution or on a secondary ray.

    Parameters
    ----------
    problem : LCP

    References
    ----------
    Lemke 1965; Cottle, Pang and Stone, Algorithm 4.4.5 and section 4.9 (lexicographic rule).
    """
    path, budget = covering(problem, np.ones(problem.n)), 50 * problem.n + 100
    ended = None if path is None else path.run(budget)
    if path is None or ended is Ended.PIVOTS:
        raise ArithmeticError(f"No solution within {budget} pivots.")
    if ended is not Ended.REACHED:
        raise ArithmeticError(f"Ended on a secondary ray after {path.pivots} pivots.")
    points = (path.values(), _solved_on(_dense(problem), path.active, np.where(path.active, -problem.q, 0.0)))
    x = min(points, key=problem.natural_residual)
    if not is_solved(problem, x):
        raise ArithmeticError("The last basis is too ill-conditioned for the residual test.")
    return x, path.pivots


def modulus(problem: LCP) -> tuple[Array, int]:
    """Solve LCP(q, A) by the modulus iteration (I + A) z_next = (I - A)|z| - q from z = 0.

    A fixed point gives x = |z| + z and w = |z| - z. It converges for symmetric P-matrices; elsewhere it may cycle or
    diverge.

    Parameters
    ----------
    problem : LCP

    References
    ----------
    van Bokhoven 1980; Schaefer, Oper. Res. Lett. 32, 2004.
    """
    z = np.zeros(problem.n)
    factors, exchanged, singular = dgetrf(_dense(problem) + np.eye(problem.n))
    if singular:
        raise ArithmeticError("The matrix I + A is singular.")
    for iteration in range(1, ITERATIONS + 1):
        size = np.abs(z)
        z = dgetrs(factors, exchanged, size - problem.A @ size - problem.q)[0]
        if not np.abs(z).max() <= 1e20:
            raise ArithmeticError(f"Diverged after {iteration} iterations.")
        if is_solved(problem, np.abs(z) + z):
            return np.abs(z) + z, iteration
    raise ArithmeticError(f"No convergence within {ITERATIONS} iterations.")


def min_newton(problem: LCP) -> tuple[Array, int]:
    """Solve LCP(q, A) from zero by damped min-Newton, the primal-dual active-set method with a line search.

    A step makes w = 0 where x_i > w_i and x = 0 elsewhere, by least squares if singular; it halves until Armijo's 1e-4
    holds, doubled for a square, at most to 2^-33, else it is whole.

    Parameters
    ----------
    problem : LCP

    References
    ----------
    Pang, Math. Oper. Res. 15, 1990; Hintermueller, Ito and Kunisch,
    SIAM J. Optim. 13, 2003.
    """

    def merit(point: Array) -> float:
        residual = np.minimum(point, problem.w(point))
        return float(residual @ residual)

    A, x = _dense(problem), np.zeros(problem.n)
    for iteration in range(ITERATIONS):
        w = problem.w(x)
        step, start = _solved_on(A, x > w, -np.minimum(x, w)), merit(x)
        lengths = (t for t in 0.5 ** np.arange(34.0) if merit(x + t * step) <= (1.0 - 2e-4 * t) * start)
        trial = x + next(lengths, 1.0) * step
        if is_solved(problem, x) and problem.natural_residual(trial) >= problem.natural_residual(x):
            return x, iteration
        x = trial
    raise ArithmeticError(f"No convergence within {ITERATIONS} iterations.")


def _solved_on(A: Array, active: NDArray[np.bool_], right: Array) -> Array:
    J = np.where(active[:, None], A, np.eye(len(A)))
    try:
        return np.asarray(np.linalg.solve(J, right))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(J, right, rcond=None)[0])
