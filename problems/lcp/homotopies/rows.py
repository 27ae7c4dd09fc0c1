"""The rows w = Ax + q of the KKT homotopy, with multipliers z.

A lower bound alone requires w >= 0, an upper one w <= 0, none w = 0, a box w = s - t with s, t >= 0.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.homotopies.cores import Pairs, larger_eliminated
from problems.lcp.homotopies.sides import Sides

_NONE = np.zeros(0)


@frozen(eq=False, slots=False)
class Rows:
    """The rows of a problem."""

    problem: MixedLCP | LCP

    @cached_property
    def sides(self) -> Sides:
        """The finite bounds."""
        return Sides(self.problem)

    @cached_property
    def boxed(self) -> NDArray[np.intp]:
        """Indices with two bounds."""
        return np.intersect1d(self.sides.low, self.sides.high)

    @cached_property
    def width(self) -> Array:
        """The widths of boxes."""
        with np.errstate(over="ignore"):
            width = self.problem.upper[self.boxed] - self.problem.lower[self.boxed]
        return np.minimum(width, float(np.finfo(float).max))

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """Which indices have no bound, shape (n,)."""
        return np.broadcast_to(np.greater(self.sides.free, 0), self.problem.n)

    @cached_property
    def end(self) -> Array | float:
        """Reference bound of gaps: lower, else upper, else zero."""
        if self.problem.standard:
            return 0.0
        low, high = self.problem.lower, self.problem.upper
        return np.where(np.isfinite(low), low, np.where(np.isfinite(high), high, 0.0))

    @cached_property
    def signs(self) -> Array:
        """Signs of w and its multiplier: -1 for an upper bound alone, shape (n,)."""
        return np.where(np.isfinite(self.problem.lower) | self.free, 1.0, -1.0)

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Multiplier ranges."""
        lower = np.where((self.signs < 0.0) | self.free, -np.inf, 0.0)
        upper = np.where(self.signs < 0.0, 0.0, np.inf)
        upper[self.boxed] = self.width
        return lower, upper

    def split(self, y: Array) -> tuple[Array, Array, Array, Array]:
        """The blocks x, z1, z2 and t of y, as views."""
        n, m, k = self.ends
        return y[:n], y[n:m], y[m:k], y[k:]

    @cached_property
    def ends(self) -> tuple[int, int, int]:
        """Ends of the blocks x, z1 and z2 of y."""
        n, m = self.problem.n, self.sides.index.size
        return n, n + m, n + m + n

    @property
    def size(self) -> int:
        """The number of unknowns: 3 for an index with one bound, 5 with two, 2 without."""
        return self.ends[2] + self.boxed.size

    def raised(self, w: Array, t: Array) -> Array:
        """The complement of z: w, in a box s = w + t."""
        if not self.boxed.size:
            return w
        raised = w.copy()
        raised[self.boxed] += t
        return raised


@frozen(eq=False, slots=False)
class RowPairs:
    """The linearised rows, ``factor dw + rest k = r``, with boxes eliminated.

    In a box ``(u-l-z) dt - t dz = r3`` gives `inner`, and r loses `taken` r3; elsewhere k = dz.
    """

    rows: Rows
    factor: Array
    rest: Array
    inner: Pairs | None = None
    taken: Array = _NONE

    @classmethod
    def of_boxes(cls, rows: Rows, factor: Array, rest: Array, above: Array, t: Array) -> RowPairs:
        """Eliminate the unknown with the larger coefficient of rows ``factor (dw + dt) + rest dz`` in boxes; `above` is
        u - l - z.
        """
        boxed = rows.boxed
        if not boxed.size:
            return cls(rows, factor, rest)
        inner, whole = larger_eliminated(-t, above), rest.copy()
        whole[boxed] = rest[boxed] * inner.a + factor[boxed] * inner.b
        return cls(rows, factor, whole, inner, rest[boxed] * inner.e + factor[boxed] * inner.f)

    @property
    def sign(self) -> int:
        """See `Pairs.sign`."""
        return 1 if self.inner is None else self.inner.sign

    @cached_property
    def turn(self) -> Array | None:
        """The factor of k in dz, shape (n,); None for ones."""
        if self.inner is None:
            return None
        turn = np.ones(self.rest.size)
        turn[self.rows.boxed] = self.inner.a
        return turn

    def right(self, r2: Array, r3: Array) -> Array:
        """The right-hand side r."""
        if self.inner is None:
            return r2
        right = r2.copy()
        right[self.rows.boxed] -= self.taken * r3
        return right

    def of(self, k: Array, r3: Array) -> tuple[Array, Array]:
        """(dz, dt)."""
        if self.inner is None:
            return k, _NONE
        dz = k.copy()
        dz[self.rows.boxed], dt = self.inner.of(k[self.rows.boxed], r3)
        return dz, dt

    def row(self, b2: Array, b3: Array) -> Array:
        """Coefficients of k in ``b2 . dz + b3 . dt``."""
        if self.inner is None or self.turn is None:
            return b2
        row = b2 * self.turn
        row[self.rows.boxed] += self.inner.row(b3)
        return row
