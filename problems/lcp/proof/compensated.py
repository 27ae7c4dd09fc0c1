"""A x + q in twice the working precision, with an error bound."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix, largest, least
from continuation.linear.silence import without_warnings
from problems.lcp.data.problem import MixedLCP
from problems.lcp.proof.inequalities import Inequalities
from problems.lcp.proof.rational import integer_rows, integers

_UNIT = float(np.finfo(float).eps) / 2
_HIGH_BITS = np.array(~0x7FFFFFF)
"""Keeps 26 leading bits of a double: products are exact."""

_BLOCK = 2**13
"""Entries in a block of rows, whose arrays fit the cache: 500 rows at once take three times as long."""

LARGEST_TERMS = 1e240
"""Rows whose terms sum to more than this, or less than its inverse, are summed in integers: products below 1e-260 are
inexact."""


def error_bound(w: Array, size: Array, terms: int) -> Array:
    """Error bound of a compensated sum w; the terms' magnitudes sum to `size`."""
    gamma = 4.0 * (terms + 2) * _UNIT
    bound: Array = 2.0 * _UNIT * np.abs(w) + gamma * gamma * size + terms * 1e-300
    return bound


@frozen(eq=False)
class Terms:
    """A x + q and |A| |x| + |q| of each row, divided by 2^exponents."""

    w: Array
    size: Array
    exponents: NDArray[Any] | int = 0

    @property
    def scaled(self) -> bool:
        """Whether some row is divided."""
        return isinstance(self.exponents, np.ndarray)

    @property
    def whole(self) -> Array:
        """A x + q in the problem's units, infinite where it overflows."""
        return np.ldexp(self.w, self.exponents) if self.scaled else self.w


@without_warnings(over="ignore", invalid="ignore", under="ignore")
def row_terms(problem: MixedLCP | Inequalities, x: Array) -> Terms:
    """The rows of A x + q, by compensated summation, in integers where products overflow or underflow; x is finite.

    References
    ----------
    Ogita, Rump and Oishi, SIAM J. Sci. Comput. 26, 2005 (Dot2, Proposition 5.5).
    """
    w, size = _rows(problem, x)
    if least(size) >= 1.0 / LARGEST_TERMS and largest(size) <= LARGEST_TERMS:
        return Terms(w, size)
    far = ~((size >= 1.0 / LARGEST_TERMS) & (size <= LARGEST_TERMS))
    far &= (problem.q != 0.0) | ((problem.A != 0.0) @ (x != 0.0).astype(float) > 0.0)
    if not far.any():
        return Terms(w, size)
    exponents, (numerators, shift) = np.zeros(w.size, dtype=np.int64), integers(x)
    for i, row in zip(np.flatnonzero(far), integer_rows(problem.A[far], problem.q[far])):
        terms = [row.constant << shift, *(v * numerators[k] for k, v in zip(row.columns, row.values))]
        total = sum(map(abs, terms))
        power = total.bit_length()
        w[i], size[i], exponents[i] = sum(terms) / (1 << power), total / (1 << power), power - row.shift - shift
    return Terms(w, size, exponents)


def _rows(problem: MixedLCP | Inequalities, x: Array) -> tuple[Array, Array]:
    A, q = problem.A, problem.q
    if problem.sparse:
        total, lost, sizes = _sparse_sums(sp.csr_array(A), q, x)
    else:
        support = x.nonzero()[0]
        if 2 * support.size <= x.size:
            A, x = A[:, support], x[support]
        rows = max(_BLOCK // max(x.size, 1), 1)
        parts = [summed(A[k : k + rows].T, x[:, None], q[k : k + rows]) for k in range(0, q.size, rows)]
        total, lost, sizes = parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)
    return total + lost, sizes


def summed(entries: Array, factors: Array, constants: Array) -> tuple[Array, Array, Array]:
    """Sums of products plus constants along the first axis: rounded sums, errors, magnitude sums."""
    terms = np.empty((len(entries) + 1, *constants.shape))
    terms[0] = constants
    lost = _two_product(entries, factors, terms[1:])
    partial = np.add.accumulate(terms, axis=0)
    lost += _lost(partial[:-1], terms[1:], partial[1:])
    return partial[-1], np.add.reduce(lost, axis=0), np.add.reduce(np.abs(terms), axis=0)


def _sparse_sums(A: Matrix, q: Array, x: Array) -> Array:
    """`summed` for a sparse matrix, whose rows are filled up with zeros to lengths of the same number of bits."""
    found, lengths = np.empty((3, q.size)), np.diff(A.indptr)
    bits = np.frexp(lengths)[1]
    for number in np.unique(bits):
        rows = np.flatnonzero(bits == number)
        k = np.arange(lengths[rows].max(initial=0))[:, None]
        place, there = A.indptr[rows] + k, k < lengths[rows]
        place = np.where(there, place, 0)
        found[:, rows] = summed(np.where(there, A.data[place], 0.0), x[A.indices[place]], q[rows])
    return found


def _lost(a: Array, b: Array, total: Array) -> Array:
    """Rounding error of a + b (Knuth)."""
    virtual = total - a
    return (a - (total - virtual)) + (b - virtual)


def _two_product(a: Array, b: Array, product: Array) -> Array:
    """Put the rounded product into `product`; return its error (Dekker)."""
    # One array for both: a call of numpy takes as long as 500 products.
    both = np.empty((2, *product.shape))
    both[0], both[1] = a, b
    high = (both.view(np.int64) & _HIGH_BITS).view(np.float64)
    (a_high, b_high), (a_low, b_low) = high, both - high
    np.multiply(both[0], both[1], out=product)
    error: Array = a_high * b_high
    error -= product
    error += a_high * b_low
    error += a_low * b_high
    error += a_low * b_low
    return error
