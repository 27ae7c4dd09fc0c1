"""Which unknowns stand in which equations, found by moving them; and groups of columns that share no equation."""

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
"""With few entries a row minds few of so many blocks: where rows mind half of them the matrix counts as full. Random
entries, eight a row, give 12 % here; of a quarter as many blocks they would fill nearly half."""

Places = NDArray[np.signedinteger[Any]]


@lru_cache(maxsize=4)
def generic(n: int) -> Array:
    """No two alike, none near zero: what is moved by them together does not cancel."""
    numbers = generic_vector(n)
    return np.asarray(np.sign(numbers) * (0.5 + 0.5 * np.abs(numbers) / np.abs(numbers).max()))


Touched = Callable[[Places, int], NDArray[np.bool_]]
"""From the label of each unknown, shape (N,), and how many labels there are, k, to the equations in which unknowns of
each label stand, shape (N, k)."""


def grouped(rows: Places, columns: Places, n: int, count: int) -> Places:
    """A group for each of `count` columns: no two of one group have a row in common (Curtis, Powell and Reid, 1974).

    By what `scipy.optimize.least_squares` groups columns with, without the sparse matrices in between, which take ten
    times as long for 1,000 of them.
    """
    from scipy.optimize._group_columns import group_sparse

    order = np.argsort(columns, kind="stable")
    starts = np.searchsorted(columns[order], np.arange(count + 1)).astype(np.int32)
    groups: Places = group_sparse(n, count, rows[order].astype(np.int32), starts)
    return groups


@frozen(eq=False, slots=False)
class Pattern:
    """Places of a square sparse matrix, column by column.

    `rows`, `columns`: Of the entries. `n`: Its order.
    """

    rows: Places
    columns: Places
    n: int

    @cached_property
    def groups(self) -> Places:
        """Of each column, shape (n,)."""
        return grouped(self.rows, self.columns, self.n, self.n)

    @cached_property
    def count(self) -> int:
        """How many groups there are."""
        return int(self.groups.max()) + 1

    @cached_property
    def directions(self) -> Array:
        """Of each group the sum of its unit vectors, then that of the parameter, then one for a check: (k, n + 1)."""
        unit = np.zeros((self.count + 2, self.n + 1))
        unit[self.groups, np.arange(self.n)] = 1.0
        unit[-2, -1] = 1.0
        unit[-1] = generic(self.n + 1)
        return unit

    @cached_property
    def weights(self) -> Array:
        """Of each entry, the last direction in its column."""
        found: Array = self.directions[-1][self.columns]
        return found

    @cached_property
    def _places(self) -> Places:
        return np.asarray(self.rows * (self.count + 2) + self.groups[self.columns])

    def entries(self, products: Array) -> Array:
        """The entries, from products with `directions`, shape (n, k)."""
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
        """Whether at least half of the band is there: LU within it then does hardly more than a sparse one."""
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

    def structure(self) -> Matrix:
        """Ones, csr, transposed, and a full last row: of each component of u, the equations in which it stands."""
        own = sp.csr_array((np.ones(self.rows.size), (self.columns, self.rows)), shape=(self.n, self.n))
        return sp.vstack([own, np.ones((1, self.n))], format="csr")

    def joined(self, other: Pattern) -> Pattern:
        """All places of both."""
        return pattern_of(np.append(self.rows, other.rows), np.append(self.columns, other.columns), self.n)


def pattern_of(rows: Any, columns: Any, n: int) -> Pattern:
    """These places, in order and each once."""
    columns, rows = np.divmod(np.unique(np.asarray(columns, np.intp) * n + np.asarray(rows, np.intp)), n)
    return Pattern(rows, columns, n)


def found(touched: Touched, n: int) -> Pattern | None:
    """The pattern of a square matrix, by halving blocks of columns; None where it is full, or n looks would not do.

    What is known of the blocks tells which of them share no equation: their halves are looked at together. The places
    are found by log2(n) times twice as many looks as there are groups (Griewank and Mitev, Mathematical Programming 93,
    2002).
    """
    # Of 8 blocks nothing is known: looks at their 16 halves cost no more than first to find out.
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
