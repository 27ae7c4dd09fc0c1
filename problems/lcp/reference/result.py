"""What every reference method returns, and the test of success that they share."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from problems.lcp.data.problem import LCP

SOLVED_BELOW = 1e-8
"""A method solved the problem if the natural residual of its x is at most this, relative to 1 + |q|_inf.

Not relative to |x|: for a matrix that is not R0 a diverging iterate may have an arbitrarily small relative residual.
"""


@frozen(eq=False)
class ReferenceResult:
    """The outcome of a reference method, checked afresh on the data.

    Attributes
    ----------
    x, w : Array of shape (n,) or None
        The last iterate and A x + q; None if the method ended without one (Lemke on a ray).
    solved : bool
        Whether the natural residual of x is at most `SOLVED_BELOW` (1 + |q|_inf): computed, not claimed.
    residual : float
        The natural residual, absolute; infinite without x.
    iterations, factorizations : int
        Pivots or iterations, and matrices factored.
    message : str
        How it ended, a sentence.
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


def at_point(problem: LCP, x: Array, iterations: int, factorizations: int, failure: str) -> ReferenceResult:
    """The result for a last iterate x, solved or not as the residual says; `failure` is the sentence if not."""
    solved = is_solved(problem, x)
    message = f"Solved in {iterations} iterations." if solved else failure
    residual = problem.natural_residual(x)
    return ReferenceResult(x, problem.w(x), solved, residual, iterations, factorizations, message)


def without_point(iterations: int, factorizations: int, failure: str) -> ReferenceResult:
    """The result of a method that ended without an x."""
    return ReferenceResult(None, None, False, float("inf"), iterations, factorizations, failure)
