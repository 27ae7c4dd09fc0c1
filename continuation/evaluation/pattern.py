"""Sparsity patterns, and groups of columns."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix, generic_vector
from continuation.linear import Banded

BLOCKS_TELL = 64
"""Blocks that show sparsity: eight random entries a row touch 12 % of 64, nearly half of 16. Half means a full
matrix."""

Places = NDArray[np.signedinteger[Any]]


@lru_cache(maxsize=4)
def generic(n: int) -> Array:
    """A vector without equal or tiny components, so that nothing cancels."""
    numbers = generic_vector(n)
    return np.asarray(np.sign(numbers) * (0.5 + 0.5 * np.abs(numbers) / np.abs(numbers).max()))


Touched = Callable[[Places, int], NDArray[np.bool_]]
"""Maps labels of unknowns, shape (N,), and their number k to the equations that depend on each label, shape (N, k)."""


def grouped(rows: Places, columns: Places, n: int, count: int) -> Places:
    """Groups of columns without common rows (Curtis, Powell and Reid, 1974).

    scipy's private routine is ten times as fast as its public one for 1,000 columns.
    """
    from scipy.optimize._group_columns import group_sparse

    order = np.argsort(columns, kind="stable")
    starts = np.searchsorted(columns[order], np.arange(count + 1)).astype(np.int32)
    groups: Places = group_sparse(n, count, rows[order].astype(np.int32), starts)
    return groups


@frozen(eq=False, slots=False)
class Pattern:
    """Entries of a square sparse matrix of order `n`, column by column."""

    rows: Places
    columns: Places
    n: int

    @cached_property
    def groups(self) -> Places:
        """Group of each column, shape (n,)."""
        return grouped(self.rows, self.columns, self.n, self.n)

    @cached_property
    def count(self) -> int:
        """Number of groups."""
        return int(self.groups.max()) + 1

    @cached_property
    def directions(self) -> Array:
        """Sums of unit vectors by group, the parameter's, and a vector for the check: (k, n + 1)."""
        unit = np.zeros((self.count + 2, self.n + 1))
        unit[self.groups, np.arange(self.n)] = 1.0
        unit[-2, -1] = 1.0
        unit[-1] = generic(self.n + 1)
        return unit

    @cached_property
    def _places(self) -> Places:
        return np.asarray(self.rows * (self.count + 2) + self.groups[self.columns])

    def entries(self, products: Array) -> Array:
        """Entries from products with `directions`, shape (n, k)."""
        return products.ravel().take(self._places)

    @cached_property
    def _band(self) -> tuple[int, int]:
        below = self.rows - self.columns
        return max(int(below.max(initial=0)), 0), max(int(-below.min(initial=0)), 0)

    @cached_property
    def _in_band(self) -> Places:
        return np.asarray((self._band[1] + self.rows - self.columns) * self.n + self.columns)

    @cached_property
    def banded(self) -> bool:
        """Whether entries fill half of the band."""
        return (sum(self._band) + 1) * self.n <= 2 * self.rows.size

    @cached_property
    def _starts(self) -> Places:
        return np.searchsorted(self.columns, np.arange(self.n + 1)).astype(np.int32)

    @cached_property
    def _indices(self) -> Places:
        return self.rows.astype(np.int32)

    def matrix(self, entries: Array) -> Matrix:
        """The matrix with these entries: `Banded` or csc."""
        if not self.banded:
            return sp.csc_array((entries, self._indices, self._starts), shape=(self.n, self.n))
        lower, upper = self._band
        ab = np.zeros((lower + upper + 1, self.n))
        ab.ravel().put(self._in_band, entries)
        return Banded(ab, lower, upper)

    def joined(self, other: Pattern) -> Pattern:
        """Union of two patterns."""
        return pattern_of(np.append(self.rows, other.rows), np.append(self.columns, other.columns), self.n)


def pattern_of(rows: Any, columns: Any, n: int) -> Pattern:
    """Pattern of these entries, sorted, without repetition."""
    columns, rows = np.divmod(np.unique(np.asarray(columns, np.intp) * n + np.asarray(rows, np.intp)), n)
    return Pattern(rows, columns, n)


def found(touched: Touched, n: int) -> Pattern | None:
    """A matrix' pattern, or None if it is full or costs too much.

    Blocks of columns are halved, those without common equations together (Griewank and Mitev, Mathematical Programming
    93, 2002).
    """
    # 8 blocks cost as much as their 16 halves.
    shift = max(int(n - 1).bit_length() - 3, 0)
    columns = np.arange(n)
    rows, blocks = (places.ravel() for places in np.meshgrid(columns, np.unique(columns >> shift)))
    spent = 0
    while shift:
        shift -= 1
        halves = columns >> shift
        groups = grouped(rows, blocks, n, int(halves[-1] >> 1) + 1)
        count = 2 * (int(groups.max()) + 1)
        spent += count
        if spent > n or 2 * rows.size > n * (halves[-1] >> 1) >= n * BLOCKS_TELL:
            return None
        seen = touched(2 * groups[halves >> 1] + (halves & 1), count)
        label = 2 * groups[blocks]
        left, right = seen[rows, label], seen[rows, label + 1]
        rows, blocks = np.append(rows[left], rows[right]), np.append(2 * blocks[left], 2 * blocks[right] + 1)
    return pattern_of(rows, blocks, n)
