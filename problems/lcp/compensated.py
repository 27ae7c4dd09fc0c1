"""A x + q as if computed in twice the working precision, with a bound on what is left of the error."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.problem import LCP

_UNIT = float(np.finfo(float).eps) / 2
_HIGH_BITS = np.int64(~0x7FFFFFF)
"""Keeps the leading 26 bits of a double: the product of two such numbers is exact."""


def accurate_w(problem: LCP, x: Array) -> tuple[Array, Array]:
    """W = A x + q by compensated summation of error-free products, and a bound on the error of each entry.

    Parameters
    ----------
    problem : LCP
        Dense or sparse; no copy of A is made.
    x : Array of shape (n,)
        Finite.

    Returns
    -------
    w, bound : Array of shape (n,)
        |w_i - (A x + q)_i| <= bound_i; both infinite where a product overflows.

    References
    ----------
    Ogita, Rump and Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26, 2005 (Dot2, Proposition 5.5).
    """
    total = problem.q.copy()
    lost = np.zeros(problem.n)
    size = np.abs(problem.q)
    terms = 1
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        for rows, entries, factors in _terms(problem, x):
            product, error = _two_product(entries, factors)
            summed, rounding = _two_sum(total[rows], product)
            total[rows] = summed
            lost[rows] += error + rounding
            size[rows] += np.abs(product)
            terms += 1
        w = total + lost
        gamma = 4.0 * (terms + 2) * _UNIT
        bound = 2.0 * _UNIT * np.abs(w) + gamma * gamma * size + terms * 1e-300
    overflowed = ~np.isfinite(w) | ~np.isfinite(bound)
    return np.where(overflowed, np.inf, w), np.where(overflowed, np.inf, bound)


def _terms(problem: LCP, x: Array) -> Iterator[tuple[Any, Array, Array]]:
    """(rows, entries of A, entries of x), no row twice in one term: a column of A, or the k-th entry of each row."""
    if not problem.sparse:
        for j in np.flatnonzero(x):
            yield slice(None), problem.A[:, j], np.full(problem.n, x[j])
        return
    stored = sp.csr_array(problem.A)
    lengths: NDArray[Any] = np.diff(stored.indptr)
    longest_first = np.argsort(-lengths, kind="stable")
    ordered = lengths[longest_first]
    for k in range(int(ordered[0])):
        rows = longest_first[: int(np.searchsorted(-ordered, -k, side="left"))]
        position = stored.indptr[rows] + k
        yield rows, stored.data[position], x[stored.indices[position]]


def _two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """The rounded sum and its rounding error, exactly (Knuth)."""
    total = a + b
    virtual = total - a
    return total, (a - (total - virtual)) + (b - virtual)


def _two_product(a: Array, b: Array) -> tuple[Array, Array]:
    """The rounded product and its rounding error to 2^-106 (Dekker, split by masking so that it cannot overflow)."""
    product = a * b
    a_high, b_high = _high(a), _high(b)
    a_low, b_low = a - a_high, b - b_high
    error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
    return product, error


def _high(a: Array) -> Array:
    leading: Array = (np.ascontiguousarray(a).view(np.int64) & _HIGH_BITS).view(np.float64)
    return leading
