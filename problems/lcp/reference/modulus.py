"""The modulus iteration: the LCP as an equation in z with x = |z| + z and w = omega (|z| - z)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from continuation.arrays import Array
from continuation.linear.superlu import factor_superlu
from problems.lcp.data.problem import LCP
from problems.lcp.reference.result import ReferenceResult, at_point, is_solved, without_point

_DIVERGED = 1e20
"""An iterate of this size is on its way to overflow; no problem in floats of usual size has such a solution."""


def modulus(problem: LCP, omega: float = 1.0, z: Array | None = None, max_iterations: int = 10_000) -> ReferenceResult:
    """Solve LCP(q, A) by the modulus iteration (omega I + A) z_next = (omega I - A)|z| - q.

    A fixed point gives x = |z| + z >= 0 and w = omega (|z| - z) >= 0 with x_i w_i = 0. It converges for
    symmetric P matrices and some others; elsewhere it may cycle or diverge, which is said.

    Parameters
    ----------
    problem : LCP
    omega : float
        Positive; 1 is the iteration of van Bokhoven and Schaefer. It decides which indefinite problems it solves.
    z : Array of shape (n,), optional
        The start; zero by default.
    max_iterations : int

    Raises
    ------
    ValueError
        If omega is not positive and finite, or z has another shape.

    References
    ----------
    van Bokhoven 1980; Schaefer, On the modulus algorithm for the LCP, Oper. Res. Lett. 32, 2004.
    """
    if not (omega > 0 and np.isfinite(omega)):
        raise ValueError(f"omega: expected a positive finite number, found {omega}")
    z = np.zeros(problem.n) if z is None else np.array(z, dtype=float)
    if z.shape != (problem.n,):
        raise ValueError(f"z: expected shape ({problem.n},), found {z.shape}")
    solve = _factored(problem, omega)
    if solve is None:
        return without_point(0, 1, f"The matrix {omega} I + A is singular.")
    x = np.abs(z) + z
    for iteration in range(1, max_iterations + 1):
        size = np.abs(z)
        z = solve(omega * size - problem.A @ size - problem.q)
        if not np.isfinite(z).all() or np.abs(z).max() > _DIVERGED:
            return at_point(problem, x, iteration, 1, f"Diverged after {iteration} iterations.")
        x = np.abs(z) + z
        if is_solved(problem, x):
            break
    return at_point(problem, x, iteration, 1, f"No convergence within {max_iterations} iterations.")


def _factored(problem: LCP, omega: float) -> Callable[[Array], Array] | None:
    """The solver of (omega I + A), or None if that is singular."""
    if problem.sparse:
        factored = factor_superlu(sp.csc_array(problem.A + omega * sp.eye_array(problem.n)))
        return None if factored is None else factored.solve
    factors, swaps, info = scipy.linalg.lapack.dgetrf(problem.A + omega * np.eye(problem.n))
    if info != 0:
        return None

    def solve(right: Array) -> Array:
        solution: Array = scipy.linalg.lapack.dgetrs(factors, swaps, right)[0]
        return solution

    return solve
