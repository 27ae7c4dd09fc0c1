"""A x + q as if computed in twice the working precision, with a bound on what is left of the error."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import LCP

_UNIT = float(np.finfo(float).eps) / 2
_HIGH_BITS = np.int64(~0x7FFFFFF)
"""Keeps the leading 26 bits of a double: the product of two such numbers is exact."""

_BLOCK = 2**15
"""Entries of A in a block of rows."""


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
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        total, lost, size, terms = _sparse_sums(problem, x) if problem.sparse else _dense_sums(problem, x)
        w = total + lost
        gamma = 4.0 * (terms + 2) * _UNIT
        bound = 2.0 * _UNIT * np.abs(w) + gamma * gamma * size + terms * 1e-300
    overflowed = ~np.isfinite(w) | ~np.isfinite(bound)
    return np.where(overflowed, np.inf, w), np.where(overflowed, np.inf, bound)


def _dense_sums(problem: LCP, x: Array) -> tuple[Array, Array, Array, int]:
    """(sum, what it lost, sum of magnitudes, number of terms) of each row, by blocks of rows that stay in the cache."""
    support = np.flatnonzero(x)
    factors, everywhere = x[support], support.size == problem.n
    total, lost, size = problem.q.copy(), np.zeros(problem.n), np.abs(problem.q)
    step = max(_BLOCK // max(support.size, 1), 1)
    for begin in range(0, problem.n if support.size else 0, step):
        rows = slice(begin, begin + step)
        entries = problem.A[rows] if everywhere else problem.A[rows][:, support]
        product, error = _two_product(entries, factors)
        lost[rows] += error.sum(axis=1)
        size[rows] += np.abs(product).sum(axis=1)
        # In halves: a row of k terms is summed in log2(k) passes over arrays, and every rounding error is kept.
        while product.shape[1] > 1:
            half = product.shape[1] // 2
            summed, rounding = _two_sum(product[:, :half], product[:, half : 2 * half])
            lost[rows] += rounding.sum(axis=1)
            product = summed if 2 * half == product.shape[1] else np.hstack([summed, product[:, -1:]])
        total[rows], rounding = _two_sum(total[rows], product[:, 0])
        lost[rows] += rounding
    return total, lost, size, support.size + 1


def _sparse_sums(problem: LCP, x: Array) -> tuple[Array, Array, Array, int]:
    """The same for a sparse matrix: the k-th stored entry of each row together."""
    total, lost, size = problem.q.copy(), np.zeros(problem.n), np.abs(problem.q)
    stored = sp.csr_array(problem.A)
    lengths: NDArray[Any] = np.diff(stored.indptr)
    longest_first = np.argsort(-lengths, kind="stable")
    ordered = lengths[longest_first]
    for k in range(int(ordered[0])):
        # Slices where every row has a k-th entry: gathering rows costs more than the sums do.
        everywhere = k < ordered[-1]
        rows = slice(None) if everywhere else longest_first[: int(np.searchsorted(-ordered, -k, side="left"))]
        position = (stored.indptr[:-1] if everywhere else stored.indptr[rows]) + k
        product, error = _two_product(stored.data[position], x[stored.indices[position]])
        total[rows], rounding = _two_sum(total[rows], product)
        lost[rows] += error + rounding
        size[rows] += np.abs(product)
    return total, lost, size, int(ordered[0]) + 1


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
