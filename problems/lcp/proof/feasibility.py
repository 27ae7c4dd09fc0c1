"""Whether a system z >= 0, A z + q >= 0 has a solution, and else a multiplier y: by Lemke's method, or by HiGHS."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.optimize import linprog

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.almost import Ended
from problems.lcp.pivoting.starts import covering

HIGHS_TOLERANCE = 1e-10
"""The tightest feasibility tolerance that HiGHS accepts."""

LARGEST_PIVOTED = 50
"""Order of A up to which this is quicker than a call of HiGHS: 0.2 and 1.1 ms at n = 4, 2.0 and 2.5 ms at n = 40."""

PIVOTS_PER_ROW = 4
"""Pivots, times the order, after which it is left to a linear program."""

ROW_ROUNDING = 1e-13
"""Of the terms of a row: what is off by more is left to a linear program too."""


def by_pivots(A: Array, q: Array) -> tuple[bool, Array | None]:
    """Whether there clearly is a solution; else perhaps a multiplier y >= 0, A'y <= 0 < -q'y, which is to be checked.

    The LCP of ``[[0, -A'], [A, 0]]`` and (0, q) is monotone, so its path ends at a solution or on a ray that is y.

    `A` of shape (m, k). `q` of shape (m,).

    References
    ----------
    Cottle, Pang and Stone, Theorem 4.4.12.
    """
    m, k = A.shape
    whole = np.zeros((k + m, k + m))
    whole[:k, k:], whole[k:, :k] = -A.T, A
    path = covering(LCP(whole, np.append(np.zeros(k), q)), np.ones(k + m))
    ended = None if path is None else path.run(PIVOTS_PER_ROW * (k + m))
    if path is None or ended not in (Ended.REACHED, Ended.RAY):
        return False, None
    if ended is Ended.RAY:
        return False, path.ray()[k:]
    z = path.values()[:k]
    return bool((A @ z + q >= -ROW_ROUNDING * (np.abs(A) @ z + np.abs(q))).all()), None


def by_linear_program(matrix: Matrix, vector: Array) -> Array | None:
    """The y that minimises q'y subject to A'y <= 0, sum y = 1, y >= 0; None if there is none, or HiGHS gave up.

    `matrix`, of shape (m, k): A. `vector`, of shape (m,): Its q.
    """
    n = vector.size
    total = sp.csr_array(np.ones((1, n))) if sp.issparse(matrix) else np.ones((1, n))
    result = linprog(
        vector, A_ub=transposed(matrix), b_ub=np.zeros(matrix.shape[1]), A_eq=total, b_eq=[1.0], bounds=(0, None),
        method="highs",
        options={"primal_feasibility_tolerance": HIGHS_TOLERANCE, "dual_feasibility_tolerance": HIGHS_TOLERANCE},
    )  # fmt: skip
    if result.status != 0:
        return None
    solution: Array = np.maximum(result.x, 0.0)
    return solution


def transposed(matrix: Matrix) -> Matrix:
    """A', stored as A is."""
    return sp.csr_array(matrix.T) if sp.issparse(matrix) else matrix.T
