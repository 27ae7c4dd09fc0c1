"""Exact linear algebra on floats as integer rows, with Dixon's p-adic solution of M z = b.

Every result is checked in integers.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import gcd, isqrt
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix

Integers = NDArray[Any]
"""An object array of Python integers."""

PRIMES = (2_147_483_647, 2_147_483_629, 2_147_483_587)
"""Residue products fit an int64; there are several, since one may divide a determinant."""


@frozen
class IntegerRow:
    """A row of [matrix, vector] times 2^shift: nonzero columns, integers, constant."""

    columns: NDArray[Any]
    values: list[int]
    constant: int
    shift: int

    def times(self, numerators: list[int], denominator: int) -> int:
        """Row value at numerators / denominator, times denominator."""
        total = self.constant * denominator
        for column, value in zip(self.columns, self.values):
            total += value * numerators[column]
        return total


def integers(values: Array) -> tuple[list[int], int]:
    """Integers m and k >= 0 with values = m / 2^k."""
    mantissas, exponents = np.frexp(values)
    whole = np.ldexp(mantissas, 53).astype(np.int64).tolist()
    powers = np.where(mantissas == 0.0, 0, exponents - 53)
    shift = max(0, -int(powers.min(initial=0)))
    return [m << (int(p) + shift) if m else 0 for m, p in zip(whole, powers)], shift


def integer_rows(matrix: Matrix, vector: Array) -> list[IntegerRow]:
    """Rows of [matrix, vector] as integers."""
    rows, stored = [], sp.csr_array(matrix)
    for i, constant in enumerate(vector):
        span = slice(stored.indptr[i], stored.indptr[i + 1])
        whole, shift = integers(np.append(stored.data[span], constant))
        rows.append(IntegerRow(stored.indices[span], whole[:-1], whole[-1], shift))
    return rows


def block_of(rows: Sequence[IntegerRow], columns: NDArray[np.intp], n: int) -> Integers:
    """Selected columns of rows."""
    block = np.zeros((len(rows), columns.size), dtype=object)
    for i, row in enumerate(rows):
        whole: Integers = np.zeros(n, dtype=object)
        whole[row.columns] = np.array(row.values, dtype=object)
        block[i] = whole[columns]
    return block


def solve_exactly(matrix: Integers, right: list[int], guess: Array) -> tuple[list[int], int] | None:
    """A rational solution of an integer system of any shape and rank, or None if inconsistent.

    Large entries of `guess` get pivots first; columns without a pivot keep its values. Returns (numerators,
    denominator), checked on every row.

    References
    ----------
    Dixon, Numer. Math. 40, 1982.
    """
    kept, shift = integers(guess)
    for prime in PRIMES:
        rows, columns, inverse = _invert(matrix, np.argsort(-np.abs(guess), kind="stable"), prime)
        free = np.setdiff1d(np.arange(guess.size), columns)
        numerators, denominator = list(kept), 1 << shift
        if columns.size:
            moved = np.array(right, dtype=object)[rows] << shift
            if free.size:
                moved = moved - matrix[np.ix_(rows, free)] @ np.array(kept, dtype=object)[free]
            lifted = _dixon(matrix[np.ix_(rows, columns)], moved, inverse, prime)
            if lifted is None:
                continue
            solved, scale = lifted
            numerators = [value * scale for value in numerators]
            denominator *= scale
            for column, value in zip(columns, solved):
                numerators[column] = value
        product = matrix @ np.array(numerators, dtype=object) if guess.size else np.zeros(len(right), dtype=object)
        if all(left == value * denominator for left, value in zip(product, right)):
            common = gcd(denominator, *numerators)
            return [value // common for value in numerators], denominator // common
    return None


def full_row_rank(matrix: Integers) -> bool:
    """Whether rows are independent modulo a prime; False proves nothing."""
    order = np.arange(matrix.shape[1])
    return any(_invert(matrix, order, prime)[0].size == matrix.shape[0] for prime in PRIMES)


def fractions(numerators: list[int], denominator: int) -> tuple[Fraction, ...]:
    """Reduced fractions."""
    return tuple(Fraction(value, denominator) for value in numerators)


def _invert(matrix: Integers, order: NDArray[Any], prime: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    m = matrix.shape[0]
    work = np.hstack([(matrix % prime).astype(np.int64), np.eye(m, dtype=np.int64)])
    unused = np.ones(m, dtype=bool)
    rows, columns = [], []
    for column in order:
        nonzero = np.flatnonzero(unused & (work[:, column] != 0))
        if nonzero.size == 0:
            continue
        row = int(nonzero[0])
        work[row] = work[row] * pow(int(work[row, column]), -1, prime) % prime
        others = np.flatnonzero(work[:, column])
        others = others[others != row]
        work[others] = (work[others] - work[others, column][:, None] * work[row]) % prime
        unused[row] = False
        rows.append(row)
        columns.append(int(column))
    k = matrix.shape[1]
    chosen = np.array(rows, dtype=np.intp)
    return chosen, np.array(columns, dtype=np.intp), work[np.ix_(chosen, k + chosen)]


def _dixon(block: Integers, right: Integers, inverse: NDArray[Any], prime: int) -> tuple[list[int], int] | None:
    residual, power, attempt = right, 1, prime**4
    expansion = np.zeros(right.size, dtype=object)
    bits = sum(int(sum(int(v) ** 2 for v in row)).bit_length() / 2 + 1 for row in block)
    enough = 2 ** int(2 * (bits + max(int(abs(value)).bit_length() for value in right)) + prime.bit_length())
    while True:
        reduced = (residual % prime).astype(np.int64)
        digits = (((inverse * reduced) % prime).sum(axis=1) % prime).astype(object)
        residual = (residual - block @ digits) // prime
        expansion = expansion + digits * power
        power *= prime
        if power >= min(attempt, enough):
            found = _reconstruct(expansion, power)
            if found is not None and (block @ np.array(found[0], dtype=object) == right * found[1]).all():
                return found
            if power >= enough:
                return None
            attempt = power * isqrt(power)


def _reconstruct(expansion: Integers, modulus: int) -> tuple[list[int], int] | None:
    """Numerators and denominator congruent to the expansion, or None."""
    bound = isqrt(modulus // 2)
    denominator = 1
    for value in expansion:
        # Euclid's algorithm, stopped halfway.
        before, now = modulus, int(value) * denominator % modulus
        factor_before, factor = 0, 1
        while min(now, modulus - now) > bound:
            quotient = before // now
            before, now = now, before - quotient * now
            factor_before, factor = factor, factor_before - quotient * factor
        denominator *= abs(factor)
        if denominator > bound:
            return None
    centred = [(int(value) * denominator + modulus // 2) % modulus - modulus // 2 for value in expansion]
    return centred, denominator
