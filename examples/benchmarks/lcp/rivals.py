"""The other solvers of the benchmark, all from PyPI but one: min-Newton is twenty lines here.

Each takes (problem, seconds) and returns x, or None where it gave up; the benchmark certifies x itself.
"""

import time

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from problems.lcp import LCP


def min_newton(problem: LCP, seconds: float) -> np.ndarray | None:
    """Newton's method on min(x, A x + q) = 0 without safeguards: the primal-dual active-set method."""
    began = time.perf_counter()
    A, q, n = problem.A, problem.q, problem.n
    active = q < 0.0
    seen = set()
    while time.perf_counter() - began < seconds:
        x = np.zeros(n)
        inside = np.flatnonzero(active)
        try:
            if inside.size and problem.sparse:
                x[inside] = splu(sp.csc_array(A[inside][:, inside])).solve(-q[inside])
            elif inside.size:
                x[inside] = np.linalg.solve(A[np.ix_(inside, inside)], -q[inside])
        except (np.linalg.LinAlgError, RuntimeError):
            return None
        w = A @ x + q
        following = np.where(active, x > 0.0, w < 0.0)
        if np.array_equal(following, active) or following.tobytes() in seen:
            return np.maximum(x, 0.0)
        seen.add(active.tobytes())
        active = following
    return None


def lemke(problem: LCP, seconds: float) -> np.ndarray | None:
    """Lemke's method of quantecon (numba), covering vector e."""
    from quantecon.optimize import lcp_lemke

    result = lcp_lemke(_dense(problem), problem.q, max_iter=100_000)
    return result.z if result.success else None


def restarted_lemke(problem: LCP, seconds: float) -> np.ndarray | None:
    """The same from random covering vectors near e until one succeeds or the time is up.

    Of eight distributions this solved most of the random nonmonotone problems: 2 of 12 in 4 s each, uniform ones on
    [0.5, 1.5] 1, those that spread wider none, as they end on a ray after few pivots.
    """
    from quantecon.optimize import lcp_lemke

    began, k = time.perf_counter(), 0
    A = _dense(problem)
    while time.perf_counter() - began < seconds:
        d = np.exp(0.05 * np.random.default_rng(k).standard_normal(problem.n))
        result = lcp_lemke(A, problem.q, d=d, max_iter=20 * problem.n)
        if result.success:
            return result.z
        k += 1
    return None


def piqp(problem: LCP, seconds: float) -> np.ndarray | None:
    """The quadratic program min x'Ax/2 + q'x over x >= 0 by PIQP; for symmetric positive semidefinite A."""
    import piqp as package

    n = problem.n
    solver = package.SparseSolver() if problem.sparse else package.DenseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = 1e-12
    P = sp.csc_matrix(problem.A) if problem.sparse else problem.A
    solver.setup(P, problem.q, x_l=np.zeros(n))
    solver.solve()
    return np.maximum(solver.result.x, 0.0)


def warm_up() -> None:
    """Let numba compile Lemke's method before a clock runs."""
    lemke(LCP(np.eye(2), -np.ones(2)), 1.0)


def _dense(problem: LCP) -> np.ndarray:
    return problem.A.toarray() if problem.sparse else problem.A
