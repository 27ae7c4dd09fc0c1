"""Published reference methods, on dense matrices."""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.almost import Ended
from problems.lcp.pivoting.starts import covering

SOLVED_BELOW = 1e-8
"""Largest natural residual of a solution, relative to 1 + |q|_inf; relative to |x| diverging iterates could pass."""

MODULUS_ITERATIONS, MIN_NEWTON_ITERATIONS = 10_000, 300
"""Most iterations: convergent runs take some hundred, from zero some ten."""


@frozen(eq=False)
class ReferenceResult:
    """The outcome of a reference method.

    Attributes
    ----------
    x, w : Array of shape (n,) or None
        The last iterate and A x + q.
    solved : bool
        Whether the residual is at most `SOLVED_BELOW` (1 + |q|_inf).
    residual : float
        The natural residual; infinite without x.
    iterations, factorizations : int
        Pivots or iterations; matrices factored.
    message : str
        How it ended.
    """

    x: Array | None
    w: Array | None
    solved: bool
    residual: float
    iterations: int
    factorizations: int
    message: str


def is_solved(problem: LCP, x: Array) -> bool:
    """Whether x passes the common test."""
    return problem.natural_residual(x) <= SOLVED_BELOW * (1.0 + float(np.abs(problem.q).max()))


def _result(problem: LCP, x: Array | None, iterations: int, factorizations: int, failure: str) -> ReferenceResult:
    if x is None:
        return ReferenceResult(None, None, False, float("inf"), iterations, factorizations, failure)
    solved, residual = is_solved(problem, x), problem.natural_residual(x)
    message = f"Solved in {iterations} iterations." if solved else failure
    return ReferenceResult(x, problem.w(x), solved, residual, iterations, factorizations, message)


def _dense(problem: LCP) -> Array:
    A: Array = problem.A.toarray() if problem.sparse else problem.A
    return A


def lemke(problem: LCP) -> ReferenceResult:
    """Solve LCP(q, A) by Lemke's method with the covering vector of ones.

    The lexicographically least of tied rows leaves, so it ends at a solution or on a secondary ray. It takes at most 50
    n + 100 pivots.

    Parameters
    ----------
    problem : LCP

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
        return _result(problem, None, budget, 0, f"No solution within {budget} pivots.")
    if ended is not Ended.REACHED:
        return _result(problem, None, path.pivots, 0, f"Ended on a secondary ray after {path.pivots} pivots.")
    points = (path.values(), _solved_on(_dense(problem), path.active, np.where(path.active, -problem.q, 0.0)))
    x = min(points, key=problem.natural_residual)
    return _result(problem, x, path.pivots, 1, "The last basis is too ill-conditioned for the residual test.")


def modulus(problem: LCP) -> ReferenceResult:
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
    z = x = np.zeros(problem.n)
    factors, exchanged, singular = dgetrf(_dense(problem) + np.eye(problem.n))
    if singular:
        return _result(problem, None, 0, 1, "The matrix I + A is singular.")
    for iteration in range(1, MODULUS_ITERATIONS + 1):
        size = np.abs(z)
        z = dgetrs(factors, exchanged, size - problem.A @ size - problem.q)[0]
        if not np.abs(z).max() <= 1e20:
            return _result(problem, x, iteration, 1, f"Diverged after {iteration} iterations.")
        x = np.abs(z) + z
        if is_solved(problem, x):
            break
    return _result(problem, x, iteration, 1, f"No convergence within {MODULUS_ITERATIONS} iterations.")


def min_newton(problem: LCP) -> ReferenceResult:
    """Solve LCP(q, A) from zero by damped min-Newton, the primal-dual active-set method with a line search.

    A step makes w = 0 where x_i > w_i and x = 0 elsewhere, by least squares if singular.

    Parameters
    ----------
    problem : LCP

    References
    ----------
    Pang, Math. Oper. Res. 15, 1990; Hintermueller, Ito and Kunisch,
    SIAM J. Optim. 13, 2003.
    """
    A, x = _dense(problem), np.zeros(problem.n)
    for iteration in range(MIN_NEWTON_ITERATIONS):
        w = problem.w(x)
        trial = _line_search(problem, x, _solved_on(A, x > w, -np.minimum(x, w)))
        if is_solved(problem, x) and problem.natural_residual(trial) >= problem.natural_residual(x):
            return _result(problem, x, iteration, iteration + 1, "")
        x = trial
    most = MIN_NEWTON_ITERATIONS
    return _result(problem, x, most, most, f"No convergence within {most} iterations.")


def _solved_on(A: Array, active: NDArray[np.bool_], right: Array) -> Array:
    J = np.where(active[:, None], A, np.eye(len(A)))
    try:
        return np.asarray(np.linalg.solve(J, right))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(J, right, rcond=None)[0])


def _line_search(problem: LCP, x: Array, step: Array) -> Array:
    """The first x + t step, t = 1, 1/2, ... 2^-33, that meets Armijo's 1e-4, doubled for a square, else x + step."""

    def merit(point: Array) -> float:
        residual = np.minimum(point, problem.w(point))
        return float(residual @ residual)

    start = merit(x)
    for t in 0.5 ** np.arange(34.0):
        trial: Array = x + t * step
        if merit(trial) <= (1.0 - 2e-4 * t) * start:
            return trial
    return x + step
