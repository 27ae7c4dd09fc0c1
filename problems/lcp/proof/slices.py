"""Products of a matrix and a vector in twice the working precision, by products of slices of which BLAS loses nothing.

References
----------
Ozaki, Ogita, Oishi and Rump, "Error-free transformations of matrix multiplication by using fast routines of matrix
multiplication and its applications", Numer. Algorithms 59, 2012.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from continuation.arrays import Array

DOUBLE_BITS = 53
"""Of a double."""


def sliced_terms(A: Array, x: Array, block: int) -> Iterator[tuple[slice, Array, Array]]:
    """Blocks of rows of A x as (rows, terms, sizes): the terms, along the first axis, add up to the products.

    A and x are cut into slices of so few digits that sums of products of two slices are exact: two of A, three of x,
    which are all of it. What is left of A is 2^-42 or less of the largest product of the row and multiplied as usual,
    with an error below that of sums of products in twice the working precision.

    `A` of shape (n, m). `x` of shape (m,). `block`: Rows at a time. Returns sizes: |A| |x|.
    """
    mantissas, powers = np.frexp(x)
    scale = np.where(x == 0.0, 0.0, np.ldexp(1.0, powers))
    # Integers below 2^(digits - 1): m products of two of them add up to less than 2^53.
    digits = (DOUBLE_BITS - int(np.ceil(np.log2(x.size)))) // 2 + 1
    parts, left, top = [], mantissas.copy(), np.ones(1)
    for _ in range(3):
        parts.append(_leading(left, top, digits))
        left -= parts[-1]
        top = top * 2.0**-digits
    factors = np.stack(parts, axis=1)
    for begin in range(0, len(A), block):
        rows = slice(begin, begin + block)
        # Times powers of two, so that the largest entry of a row is about its largest product.
        left = A[rows] * scale
        magnitudes = np.abs(left)
        sizes, top = magnitudes @ np.abs(mantissas), np.ldexp(1.0, np.frexp(magnitudes.max(axis=1))[1])[:, None]
        terms = np.empty((7, len(left)))
        for k in range(2):
            leading = _leading(left, top, digits)
            terms[3 * k : 3 * k + 3] = (leading @ factors).T
            left -= leading
            top = top * 2.0**-digits
        terms[6] = left @ mantissas
        yield rows, terms, sizes


def _leading(values: Array, top: Array, digits: int) -> Array:
    """So many leading digits, those above top 2^-digits, of numbers that are at most top."""
    shift = top * (1.5 * 2.0 ** (DOUBLE_BITS - digits))
    leading = values + shift
    leading -= shift
    return leading
