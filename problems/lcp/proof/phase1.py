"""Phase I: strictly feasible starts by linear programs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sp
from scipy.optimize import linprog

from continuation.arrays import Array
from problems.lcp.data.problem import LCP, require_lcp
from problems.lcp.proof.compensated import accurate_w
from problems.lcp.proof.farkas import Farkas, empty_interior, scaled_data, scales


class NoStrictlyFeasiblePoint(ValueError):
    """No x0 with x0 > 0 and A x0 + q > 0 was found.

    Attributes
    ----------
    certificate : Farkas or None
        The exact proof, if any.
    margin : float
        Largest scaled margin found; at most about 0.
    """

    def __init__(self, message: str, certificate: Farkas | None, margin: float) -> None:
        super().__init__(message)
        self.certificate = certificate
        self.margin = margin


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
    largest = float("nan")
    for x0, margin in _programs(problem):
        largest = margin
        if x0 is not None and is_strictly_feasible(problem, x0):
            return x0
    certificate = empty_interior(problem)
    said = {
        None: f"the linear program reached only the scaled margin {largest:.1e}. This is numerical: no exact proof "
        "that there is none was found. A start need not be feasible.",
        True: "proved exactly that not even x >= 0 and A x + q >= 0 holds anywhere, so the LCP has no solution.",
        False: "proved exactly that there is none. The LCP may still have solutions, and a start need not be feasible.",
    }
    reason = said[None if certificate is None else certificate.no_feasible_point]
    message = f"A, q: expected a point with x > 0 and A x + q > 0; {reason}"
    raise NoStrictlyFeasiblePoint(message, certificate, largest)


def is_strictly_feasible(problem: LCP, x: Array) -> bool:
    """Whether x > 0 and each w_i exceeds its error bound."""
    if not (np.isfinite(x).all() and (x > 0).all()):
        return False
    w, bound = accurate_w(problem, x)
    return bool((np.isfinite(w) & (w > bound)).all())


def _programs(problem: LCP) -> Iterator[tuple[Array | None, float]]:
    """The least x of margin 1; then the x of largest margin t <= 1, and t."""
    rows, columns = scales(problem)
    (matrix, vector), n, none = scaled_data(problem, rows, columns), problem.n, (None, float("nan"))
    result = linprog(np.ones(n), A_ub=-matrix, b_ub=vector - 1.0, bounds=(1.0, None), method="highs")
    yield (result.x / columns, 1.0) if result.status == 0 else none
    block, eye = (sp.block_array, sp.eye_array(n)) if problem.sparse else (np.block, np.eye(n))
    left = block([[-eye, np.ones((n, 1))], [-matrix, np.ones((n, 1))]])
    bounds = [(None, None)] * n + [(None, 1.0)]
    result = linprog(
        np.append(np.zeros(n), -1.0), A_ub=left, b_ub=np.append(np.zeros(n), vector), bounds=bounds, method="highs"
    )
    yield (result.x[:-1] / columns, float(result.x[-1])) if result.status == 0 else none
