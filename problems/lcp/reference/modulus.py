"""The modulus iteration: the LCP as an equation in z with x = |z| + z and w = |z| - z."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Array
from continuation.linear.dense import factor_lu
from continuation.linear.superlu import factor_superlu
from problems.lcp.data.problem import LCP
from problems.lcp.reference.result import ReferenceResult, at_point, is_solved, without_point

_DIVERGED = 1e20
"""An iterate of this size is on its way to overflow; no problem in floats of usual size has such a solution."""


MODULUS_ITERATIONS = 10_000
"""At most: each is a solve, and where it converges some hundred are enough."""


def modulus(problem: LCP) -> ReferenceResult:
    """Solve LCP(q, A) by the modulus iteration (I + A) z_next = (I - A)|z| - q from z = 0.

    A fixed point gives x = |z| + z >= 0 and w = |z| - z >= 0 with x_i w_i = 0. It converges for symmetric P matrices
    and some others; elsewhere it may cycle or diverge, which is said.

    Parameters
    ----------
    problem : LCP

    References
    ----------
    van Bokhoven 1980; Schaefer, On the modulus algorithm for the LCP, Oper. Res. Lett. 32, 2004.
    """
    z = x = np.zeros(problem.n)
    solve = _factored(problem)
    if solve is None:
        return without_point(0, 1, "The matrix I + A is singular.")
    for iteration in range(1, MODULUS_ITERATIONS + 1):
        size = np.abs(z)
        z = solve(size - problem.A @ size - problem.q)
        if not np.isfinite(z).all() or np.abs(z).max() > _DIVERGED:
            return at_point(problem, x, iteration, 1, f"Diverged after {iteration} iterations.")
        x = np.abs(z) + z
        if is_solved(problem, x):
            break
    return at_point(problem, x, iteration, 1, f"No convergence within {MODULUS_ITERATIONS} iterations.")


def _factored(problem: LCP) -> Callable[[Array], Array] | None:
    """The solver of I + A, or None if that is singular."""
    factored: Any
    if problem.sparse:
        factored = factor_superlu(sp.csc_array(problem.A + sp.eye_array(problem.n)))
    else:
        factored = factor_lu(np.asfortranarray(problem.A + np.eye(problem.n)))
    return None if factored is None else factored.solve
