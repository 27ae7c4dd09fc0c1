"""Exact linear algebra on small matrices, stored as integers over one positive scale."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property
from operator import mul
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from problems.lcp.classes.simplex import exchange
from problems.options import sound_sparse

IntRow = Sequence[int]
Indices = tuple[int, ...]


def _fraction(value: Any) -> Fraction:
    plain = value.item() if isinstance(value, np.generic) else value
    if isinstance(plain, float) and not math.isfinite(plain):
        raise ValueError(f"A: expected finite numbers, found {plain}")
    if not isinstance(plain, (bool, int, float, Fraction)):
        raise ValueError(f"A: expected real numbers, found {type(plain).__name__}")
    return Fraction(plain)


def over_common_denominator(values: Sequence[Fraction]) -> tuple[list[int], int]:
    """Integers and the least positive scale: values = integers / scale."""
    scale = math.lcm(*(value.denominator for value in values))
    return [value.numerator * (scale // value.denominator) for value in values], scale


@frozen(slots=False)
class ExactMatrix:
    """A square rational matrix, entries / scale.

    Parameters
    ----------
    entries : tuple of n tuples of n int
    scale : int
        Positive.
    """

    entries: tuple[tuple[int, ...], ...]
    scale: int = 1

    @staticmethod
    def of(A: Any) -> ExactMatrix:
        """Exact value of a matrix of floats, ints or Fractions.

        Parameters
        ----------
        A : array_like or scipy sparse, shape (n, n)
            The float 0.8 is not 4/5.
        """
        if isinstance(A, ExactMatrix):
            return A
        if np.ma.isMaskedArray(A) and np.ma.getmaskarray(A).any():
            raise ValueError("A: expected real numbers, found a masked array with masked entries; fill them first")
        if sp.issparse(A):
            # Rejects bad input; its floats, of 53 bits, are not used.
            sound_sparse("A", A)
            A = (A.astype(np.int64) if A.dtype.kind in "iu" and A.dtype.itemsize < 8 else A).toarray()
        dense = np.array(A, dtype=object)
        if dense.ndim != 2 or dense.shape[0] != dense.shape[1] or dense.size == 0:
            raise ValueError(f"A: expected a square matrix, found shape {dense.shape}")
        n = dense.shape[0]
        flat, scale = over_common_denominator([_fraction(value) for value in dense.flat])
        return ExactMatrix(tuple(tuple(flat[i * n : (i + 1) * n]) for i in range(n)), scale)

    @property
    def n(self) -> int:
        """The order."""
        return len(self.entries)

    @cached_property
    def transpose(self) -> ExactMatrix:
        """The transposed matrix."""
        return ExactMatrix(tuple(zip(*self.entries, strict=True)), self.scale)

    @cached_property
    def symmetric_part(self) -> ExactMatrix:
        """(A + A') / 2."""
        pairs = zip(self.entries, self.transpose.entries, strict=True)
        return ExactMatrix(tuple(tuple(a + b for a, b in zip(r, c, strict=True)) for r, c in pairs), 2 * self.scale)

    @cached_property
    def minors(self) -> tuple[int, ...]:
        """All 2^n principal minors of the integer matrix, by bit mask."""
        return tuple(principal_minors(self.entries))

    def minor(self, mask: int) -> Fraction:
        """The principal minor of an index set, in the units of A.

        Parameters
        ----------
        mask : int
            Bit i stands for index i.
        """
        return Fraction(self.minors[mask], self.scale ** mask.bit_count())

    def image(self, x: Sequence[Fraction]) -> tuple[Fraction, ...]:
        """Ax, in the units of A.

        Parameters
        ----------
        x : sequence of n Fraction
        """
        return tuple(Fraction(dot(row, x)) / self.scale for row in self.entries)


def dot(a: Sequence[int] | Sequence[Fraction], b: Sequence[int] | Sequence[Fraction]) -> Any:
    """The product a'b, an int or a Fraction."""
    return sum(map(mul, a, b))


def indices(mask: int) -> Indices:
    """The index set of the bits in `mask`."""
    return tuple(i for i in range(mask.bit_length()) if mask >> i & 1)


def index_sets(n: int) -> Iterator[int]:
    """Nonempty index sets as masks, small ones first."""
    return iter(sorted(range(1, 1 << n), key=lambda mask: (mask.bit_count(), mask)))


def principal_minors(rows: Sequence[IntRow]) -> list[int]:
    """All 2^n principal minors of an integer matrix, by mask, from shared Schur complements.

    Minors without the first index come from the remaining matrix, the others from the Schur complement. A zero pivot is
    raised by one, which the minors without the index then undo.

    References
    ----------
    Griffin and Tsatsomeros, Linear Algebra Appl. 419 (2006) 107-124.
    """
    return _minors([list(row) for row in rows], 1)


def _minors(block: list[list[int]], determinant_so_far: int) -> list[int]:
    if not block:
        return [determinant_so_far]
    top, rest = block[0], block[1:]
    without = _minors([row[1:] for row in rest], determinant_so_far)
    lifted = top[0] == 0
    pivot = determinant_so_far if lifted else top[0]
    complement = [[(pivot * v - row[0] * t) // determinant_so_far for v, t in zip(row[1:], top[1:])] for row in rest]
    with_index = _minors(complement, pivot)
    if lifted:
        with_index = [a - b for a, b in zip(with_index, without)]
    merged = [0] * (2 * len(without))
    merged[0::2], merged[1::2] = without, with_index
    return merged


def solve(rows: Sequence[IntRow], right: Sequence[IntRow]) -> tuple[list[list[int]], int] | None:
    """Numerators X and a positive denominator d with rows X = d right; None for a singular matrix.

    Pivots in integers are faster than `proof.rational.solve_exactly` up to order 20.
    """
    n = len(rows)
    table = [[*row, *(-v for v in b)] for row, b in zip(rows, right, strict=True)]
    free, basic, denominator = [*range(n)], [n] * n, 1
    for k in range(n):
        pivot = next((i for i in range(n) if basic[i] == n and table[i][k]), None)
        if pivot is None:
            return None
        denominator = exchange(table, basic, free, pivot, k, denominator)
    return [table[basic.index(k)][n:] for k in range(n)], denominator
