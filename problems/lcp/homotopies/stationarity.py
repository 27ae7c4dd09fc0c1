"""The KKT homotopy with bounds: the stationary points of the gap are the solutions of another problem with bounds.

The gap of a problem with bounds l, u and w = A x + q is, over the x that are feasible,

    sum_L (x - l) w  +  sum_U (u - x) (-w)  +  sum_B [(x - l) s + (u - x) t],    w = s - t on B, s, t >= 0,

for the indices L with a lower bound alone, U with an upper one alone and B with both; w = 0 where there is neither. Its
optimality conditions are, with a multiplier z_i of each row, d = x - l on L and B, x - u on U, and 0 elsewhere,

    x in [l, u]  complementary to  w + A'(d - z),
    z in [0, inf) on L, (-inf, 0] on U, [0, u - l] on B, any elsewhere,  complementary to  w:

a problem of order 2n. Where A is row sufficient every solution (x, z) of it gives a solution x of the first, and for
every z = d one of the first gives one of it. The proof is in docs/bounds.md.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import evolve

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import MixedLCP
from problems.lcp.homotopies.references import DUTTA_DAS_JANA
from problems.lcp.homotopies.starts import inside_start, inside_vector
from problems.lcp.homotopies.two_vector import TwoVectorHomotopy, WangHomotopy


def stationarity(problem: MixedLCP) -> MixedLCP:
    """The problem in (x, z), of order 2n, whose solutions are the stationary points of the gap.

    Parameters
    ----------
    problem : MixedLCP
    """
    low, high = np.isfinite(problem.lower), np.isfinite(problem.upper)
    measured = np.where(low | high, 1.0, 0.0)
    end = np.where(low, problem.lower, np.where(high, problem.upper, 0.0))
    A = problem.A
    with np.errstate(over="ignore"):
        top = problem.q - A.T @ end
        width = np.where(low & high, problem.upper - problem.lower, np.inf)
    matrix: Matrix
    if problem.sparse:
        matrix = sp.block_array([[A + A.T @ sp.diags_array(measured), -A.T], [A, None]], format="csr")
    else:
        matrix = np.block([[A + A.T * measured, -A.T], [A, np.zeros_like(A)]])
    return MixedLCP(
        matrix, np.concatenate([top, problem.q]),
        np.concatenate([problem.lower, np.where(low, 0.0, -np.inf)]),
        np.concatenate([problem.upper, np.where(low, width, np.where(high, 0.0, np.inf))]),
    )  # fmt: skip


def stationary_homotopy(problem: MixedLCP, x0: Any = None) -> TwoVectorHomotopy:
    """The path to a stationary point of the gap: Wang's, for the problem in (x, z); the first n unknowns are x.

    Parameters
    ----------
    problem : MixedLCP
    x0 : array_like, shape (n,), optional
        Strictly between the bounds.

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument.
    """
    both = stationarity(problem)
    start = inside_start(both)
    if x0 is not None:
        start[: problem.n] = inside_vector("x0", x0, problem)
    return evolve(WangHomotopy(both, start), name="KKT", references=(DUTTA_DAS_JANA,))


def is_stationary(problem: MixedLCP, y: Array) -> float:
    """The natural residual of the problem in (x, z) at y, relative to its `scale`; infinite where y is no such point.

    Parameters
    ----------
    problem : MixedLCP
    y : ndarray
        (x, z, forces), as on the path.
    """
    pairs = int(np.isfinite(problem.lower).sum() + np.isfinite(problem.upper).sum())
    if y.size != 2 * (problem.n + pairs):
        return np.inf
    return stationarity(problem).relative_residual(y[: 2 * problem.n])
