"""Phase I: strictly feasible starts by linear programs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sp
from scipy.optimize import linprog

from continuation.arrays import Array
from problems.lcp.data.problem import LCP, require_lcp
from problems.lcp.proof.compensated import error_bound, row_terms
from problems.lcp.proof.farkas import Farkas, farkas, scaled_data, scales


class NoStrictlyFeasiblePoint(ValueError):
    """No x0 with x0 > 0 and A x0 + q > 0 was found.

    Attributes
    ----------
    certificate : Farkas or None
        The exact proof that no point is feasible, if any.
    """

    def __init__(self, certificate: Farkas | None) -> None:
        reason = "none was found. A start need not be feasible."
        if certificate is not None:
            reason = "proved exactly that not even x >= 0 and A x + q >= 0 holds anywhere, so the LCP has no solution."
        super().__init__(f"A, q: expected a point with x > 0 and A x + q > 0; {reason}")
        self.certificate = certificate


def strictly_feasible_start(problem: LCP) -> Array:
    """Find a point of F = {x > 0, A x + q > 0} of the largest scaled margin up to 1.

    HiGHS seeks the least x of margin 1, else maximises t <= 1 with x >= t, A x + q >= t. A rigorous error bound
    verifies positivity.

    Parameters
    ----------
    problem : LCP

    Returns
    -------
    x0 : Array of shape (n,)

    Raises
    ------
    NoStrictlyFeasiblePoint
        If F is empty, or no point could be verified.

    References
    ----------
    Dutta, Das and Jana, "Bounded Homotopy Path Approach".
    """
    require_lcp(problem)
    for x0 in _programs(problem):
        if x0 is not None and is_strictly_feasible(problem, x0):
            return x0
    raise NoStrictlyFeasiblePoint(farkas(problem))


def is_strictly_feasible(problem: LCP, x: Array) -> bool:
    """Whether x > 0 and each w_i exceeds its error bound."""
    if not (np.isfinite(x).all() and (x > 0).all()):
        return False
    terms = row_terms(problem, x)
    return bool((terms.w > error_bound(terms.w, terms.size, x.size + 1)).all())


def _programs(problem: LCP) -> Iterator[Array | None]:
    """Yield the x of least sum with x >= 1 and A x + q >= 1, scaled; then that of the largest t <= 1 in place of 1."""
    rows, columns = scales(problem)
    (matrix, vector), n = scaled_data(problem, rows, columns), problem.n
    result = linprog(np.ones(n), A_ub=-matrix, b_ub=vector - 1.0, bounds=(1.0, None), method="highs")
    yield result.x / columns if result.status == 0 else None
    block, eye = (sp.block_array, sp.eye_array(n)) if problem.sparse else (np.block, np.eye(n))
    left = block([[-eye, np.ones((n, 1))], [-matrix, np.ones((n, 1))]])
    bounds = [(None, None)] * n + [(None, 1.0)]
    result = linprog(
        np.append(np.zeros(n), -1.0), A_ub=left, b_ub=np.append(np.zeros(n), vector), bounds=bounds, method="highs"
    )
    yield result.x[:-1] / columns if result.status == 0 else None
