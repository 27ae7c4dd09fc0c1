"""A x + q in twice the working precision, with an error bound."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix, largest, least
from continuation.linear.silence import without_warnings
from problems.lcp.data.problem import MixedLCP
from problems.lcp.proof.inequalities import Inequalities

_UNIT = float(np.finfo(float).eps) / 2
_HIGH_BITS = np.array(~0x7FFFFFF)
"""Keeps 26 leading bits of a double: products are exact."""

_BLOCK = 2**15
"""Entries per block of rows: two blocks of 256 KiB fit the cache."""

DOUBLE_BITS = 53
"""Bits of a double's mantissa."""

LARGEST_TERMS = 1e240
"""Rows whose terms sum to more than this, or less than its inverse, are scaled: products below 1e-260 are inexact."""


@without_warnings(over="ignore", invalid="ignore", under="ignore")
def accurate_w(problem: MixedLCP | Inequalities, x: Array) -> tuple[Array, Array]:
    """A x + q by compensated summation, with error bounds; both are infinite where a product overflows. `x` is finite.

    References
    ----------
    Ogita, Rump and Oishi, SIAM J. Sci. Comput. 26, 2005 (Dot2, Proposition 5.5).
    """
    w, size, terms = _rows(problem, x)
    bound = error_bound(w, size, terms)
    overflowed = ~np.isfinite(w) | ~np.isfinite(bound)
    return np.where(overflowed, np.inf, w), np.where(overflowed, np.inf, bound)


def error_bound(w: Array, size: Array, terms: int) -> Array:
    """Error bound of a compensated sum w; the terms' magnitudes sum to `size`."""
    gamma = 4.0 * (terms + 2) * _UNIT
    bound: Array = 2.0 * _UNIT * np.abs(w) + gamma * gamma * size + terms * 1e-300
    return bound


@frozen(eq=False)
class Terms:
    """The rows of A x + q, each divided by 2^exponents[i].

    `A` and `x` give the divided products; `w` and `size` are A x + q and |A| |x| + |q|, divided.
    """

    A: Matrix
    x: Array
    w: Array
    size: Array
    exponents: NDArray[Any] | int = 0

    @property
    def scaled(self) -> bool:
        """Whether some row is divided."""
        return isinstance(self.exponents, np.ndarray)

    def in_units(self, values: Array) -> Array:
        """Values of rows, in the problem's units."""
        return np.ldexp(values, self.exponents) if self.scaled else values


@without_warnings(over="ignore", invalid="ignore", under="ignore")
def row_terms(problem: MixedLCP | Inequalities, x: Array) -> Terms:
    """The rows of A x + q without overflow or underflow."""
    w, size, _ = _rows(problem, x)
    if not (least(size) >= 1.0 / LARGEST_TERMS and largest(size) <= LARGEST_TERMS):
        small = size < 1.0 / LARGEST_TERMS
        if (~(size <= LARGEST_TERMS) | (small & _filled(problem, x))).any():
            return _divided(problem, x)
    return Terms(problem.A, x, w, size)


def _divided(problem: MixedLCP | Inequalities, x: Array) -> Terms:
    mantissas, powers = np.frexp(x)
    stored = sp.csr_array(problem.A) if problem.sparse else problem.A
    entries, entry_powers = np.frexp(stored.data if problem.sparse else stored)
    constants, constant_powers = np.frexp(problem.q)
    lowest = np.iinfo(np.int32).min // 4
    products = entry_powers + (powers[stored.indices] if problem.sparse else powers)
    products[(entries == 0.0) | ((mantissas[stored.indices] if problem.sparse else mantissas) == 0.0)] = lowest
    exponents = np.where(constants == 0.0, lowest, constant_powers)
    if problem.sparse:
        row_of = np.repeat(np.arange(problem.n), np.diff(stored.indptr))
        np.maximum.at(exponents, row_of, products)
    else:
        row_of = np.arange(problem.n)[:, None]
        exponents = np.maximum(exponents, products.max(axis=1))
    exponents = np.where(exponents == lowest, 0, exponents)
    # Smaller products than 2^-1000 of the row's largest may vanish.
    moved = np.ldexp(entries, np.maximum(products - exponents[row_of], -1100))
    q = np.ldexp(constants, np.maximum(constant_powers - exponents, -1100))
    A = sp.csr_array((moved, stored.indices, stored.indptr), shape=stored.shape) if problem.sparse else moved
    w, size, _ = _rows(Inequalities(A, q), mantissas)
    return Terms(A, mantissas, w, size, exponents)


def _rows(problem: MixedLCP | Inequalities, x: Array) -> tuple[Array, Array, int]:
    """Returns w, magnitude sums, terms per row."""
    A, q, count = problem.A, problem.q, x.size
    if problem.sparse:
        A = sp.csr_array(A)
        total, lost, sizes, count = _sparse_sums(A, q, x)
        return total + lost, sizes, count + 1
    support = x.nonzero()[0]
    if 2 * support.size <= x.size:
        A, x = A[:, support], x[support]
    if 4 * A.size <= _BLOCK:
        total, lost, sizes = summed(A.T, x[:, None], q)
    else:
        rows = max(_BLOCK // x.size, 1)
        parts = [_sliced(A[k : k + rows], x, q[k : k + rows]) for k in range(0, q.size, rows)]
        total, lost, sizes = np.concatenate(parts, axis=1)
    return total + lost, sizes, count + 1


def _filled(problem: MixedLCP | Inequalities, x: Array) -> Any:
    support = x != 0.0
    if not support.any():
        return problem.q != 0.0
    return (problem.q != 0.0) | ((problem.A != 0.0) @ support.astype(float) > 0.0)


def summed(entries: Array, factors: Array, constants: Array) -> tuple[Array, Array, Array]:
    """Sums of products plus constants along the first axis: rounded sums, errors, magnitude sums."""
    terms = np.empty((len(entries) + 1, *constants.shape))
    terms[0] = constants
    lost = _two_product(entries, factors, terms[1:])
    partial = np.add.accumulate(terms, axis=0)
    lost += _lost(partial[:-1], terms[1:], partial[1:])
    return partial[-1], np.add.reduce(lost, axis=0), np.add.reduce(np.abs(terms), axis=0)


def _sliced(A: Array, x: Array, q: Array) -> tuple[Array, Array, Array]:
    """`summed` for a dense matrix by exact BLAS products of slices: two of A, three (all) of x.

    The rest of A is multiplied as usual.

    References
    ----------
    Ozaki, Ogita, Oishi and Rump, Numer. Algorithms 59, 2012.
    """
    mantissas, powers = np.frexp(x)
    # n products of integers below 2^(digits - 1) sum to less than 2^53.
    digits = (DOUBLE_BITS - int(np.ceil(np.log2(x.size)))) // 2 + 1
    factors = np.stack([*_leading(mantissas.copy(), np.ones(1), digits, 3)], axis=1)
    # Makes a row's largest entry about its largest product.
    left = A * np.where(x == 0.0, 0.0, np.ldexp(1.0, powers))
    magnitudes = np.abs(left)
    sizes, top = magnitudes @ np.abs(mantissas), np.ldexp(1.0, np.frexp(magnitudes.max(axis=1))[1])[:, None]
    terms = np.vstack([q, *((part @ factors).T for part in _leading(left, top, digits, 2)), left @ mantissas])
    partial = np.add.accumulate(terms, axis=0)
    return partial[-1], np.add.reduce(_lost(partial[:-1], terms[1:], partial[1:]), axis=0), sizes + np.abs(q)


def _leading(left: Array, top: Array, digits: int, count: int) -> Iterator[Array]:
    """Cut slices of `digits` bits off `left` (at most `top`); `left` keeps the rest."""
    for _ in range(count):
        shift = top * (1.5 * 2.0 ** (DOUBLE_BITS - digits))
        part = left + shift
        part -= shift
        left -= part
        top = top * 2.0**-digits
        yield part


def _sparse_sums(A: Matrix, q: Array, x: Array) -> tuple[Array, Array, Array, int]:
    """`summed` for a sparse matrix, and the longest row's length."""
    total, lost, size = q.copy(), np.zeros(q.size), np.abs(q)
    lengths: NDArray[Any] = np.diff(A.indptr)
    longest_first = np.argsort(-lengths, kind="stable")
    ordered = lengths[longest_first]
    for k in range(int(ordered[0])):
        # Slices avoid gathering rows.
        everywhere = k < ordered[-1]
        rows = slice(None) if everywhere else longest_first[: int(np.searchsorted(-ordered, -k, side="left"))]
        position = A.indptr[:-1][rows] + k
        product = np.empty_like(position, dtype=float)
        error = _two_product(A.data[position], x[A.indices[position]], product)
        after = total[rows] + product
        lost[rows] += error + _lost(total[rows], product, after)
        total[rows] = after
        size[rows] += np.abs(product)
    return total, lost, size, int(ordered[0])


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
