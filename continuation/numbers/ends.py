"""Intervals as lower and upper ends, with arithmetic rounded outward.

An end is nan if the operation is undefined on part of the interval; comparisons with nan are false.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from attrs import frozen

from continuation.arrays import EPS, Array, Mask

TINIEST = 2.0**-1074
"""Largest underflow error of an operation."""


def down(x: Array) -> Array:
    """The next lower number."""
    return np.nextafter(x, -np.inf)


def up(x: Array) -> Array:
    """The next higher number."""
    return np.nextafter(x, np.inf)


def up_sum(x: Array) -> Array:
    """A number above every real sum that rounds to x, by at most two ulps; x if zero.

    EPS |x| is at least the distance to the next number; zero and subnormal sums are exact. `nextafter` takes several
    times as long.
    """
    return x + EPS * np.abs(x)


def _outward(x: Array, out: Array) -> Array:
    np.multiply(np.abs(x, out=out), EPS, out=out)
    return np.add(out, TINIEST, out=out)


@frozen(eq=False)
class Ends:
    """An array of intervals [lo, hi]."""

    lo: Array
    hi: Array

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array."""
        return self.lo.shape

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return self.lo.ndim

    def __len__(self) -> int:
        return len(self.lo)

    def __getitem__(self, key: Any) -> Ends:
        return moved(operator.itemgetter(key), self)

    def __setitem__(self, key: Any, value: Ends) -> None:
        if self.lo is self.hi:
            raise ValueError("both ends are one array, into which no interval can be written: copy it first")
        self.lo[key], self.hi[key] = value.lo, value.hi

    def copy(self) -> Ends:
        """A copy, as two arrays."""
        return Ends(self.lo.copy(), self.hi.copy())

    def __neg__(self) -> Ends:
        return Ends(-self.hi, -self.lo)

    def __add__(self, other: Ends | float) -> Ends:
        other = as_ends(other)
        return Ends(-up_sum(-self.lo - other.lo), up_sum(self.hi + other.hi))

    __radd__ = __add__

    def __sub__(self, other: Ends | float) -> Ends:
        other = as_ends(other)
        return Ends(-up_sum(other.hi - self.lo), up_sum(self.hi - other.lo))

    def __rsub__(self, other: float) -> Ends:
        return as_ends(other) - self

    def __mul__(self, other: Ends | float) -> Ends:
        return whole_power(self, 2) if other is self else self._times(as_ends(other))

    __rmul__ = __mul__

    def _times(self, other: Ends) -> Ends:
        # In place: allocation takes as long as multiplication.
        a, b = np.asarray(self.lo * other.lo), np.asarray(self.lo * other.hi)
        lo, hi = np.asarray(np.minimum(a, b)), np.asarray(np.maximum(a, b))
        if self.lo is not self.hi:
            for product in (np.multiply(self.hi, other.lo, out=a), np.multiply(self.hi, other.hi, out=b)):
                lo, hi = np.minimum(lo, product, out=lo), np.maximum(hi, product, out=hi)
        # TINIEST covers underflow; products with zero are exact.
        zero = None if np.all(hi) else (lo == 0.0) & (hi == 0.0)
        lo, hi = lo - _outward(lo, a), hi + _outward(hi, b)
        if zero is not None and zero.any():
            zero &= ((self.lo == 0.0) & (self.hi == 0.0)) | ((other.lo == 0.0) & (other.hi == 0.0))
            lo, hi = np.where(zero, 0.0, lo), np.where(zero, 0.0, hi)
        return Ends(lo, hi)

    def __truediv__(self, other: Ends | float) -> Ends:
        other = as_ends(other)
        with np.errstate(all="ignore"):
            a, b = self.lo / other.lo, self.lo / other.hi
            c, d = self.hi / other.lo, self.hi / other.hi
        lo, hi = np.minimum(np.minimum(a, b), np.minimum(c, d)), np.maximum(np.maximum(a, b), np.maximum(c, d))
        defined = (other.lo > 0.0) | (other.hi < 0.0)
        return Ends(np.where(defined, down(lo), np.nan), np.where(defined, up(hi), np.nan))

    def __rtruediv__(self, other: float) -> Ends:
        return as_ends(other) / self

    def __pow__(self, n: int) -> Ends:
        return whole_power(self, n) if n >= 0 else 1.0 / whole_power(self, -n)

    def where(self, condition: Mask) -> Ends:
        """The intervals, nan where `condition` is false."""
        return Ends(np.where(condition, self.lo, np.nan), np.where(condition, self.hi, np.nan))

    def middle(self) -> Array:
        """A number inside, for finite ends."""
        return 0.5 * self.lo + 0.5 * self.hi

    def radius(self, middle: Array) -> Array:
        """A bound of the distance from `middle`."""
        return np.maximum(up_sum(self.hi - middle), up_sum(middle - self.lo))

    def magnitude(self) -> Array:
        """Largest absolute value."""
        return np.maximum(np.abs(self.lo), np.abs(self.hi))


def thin(x: Array) -> Ends:
    """Intervals of one number each."""
    return Ends(x, x)


def as_ends(x: Ends | float) -> Ends:
    """`x` itself, or a number as an interval."""
    return x if isinstance(x, Ends) else thin(np.asarray(x, dtype=float))


NumbersOrEnds = TypeVar("NumbersOrEnds", Array, Ends)


def moved(move: Callable[..., Array], *arrays: NumbersOrEnds) -> NumbersOrEnds:
    """Apply `move` to numbers or both ends; shared ends stay shared."""
    if not isinstance(arrays[0], Ends):
        return move(*arrays)
    lo = move(*(x.lo for x in arrays))
    return Ends(lo, lo if all(x.lo is x.hi for x in arrays) else move(*(x.hi for x in arrays)))


def added(add: Callable[[Array], Array], x: NumbersOrEnds, count: int) -> NumbersOrEnds:
    """Sums of up to `count` entries, in any order of `add`."""
    if not isinstance(x, Ends):
        return np.asarray(add(x))
    if count <= 1:
        return moved(add, x)
    error = accumulated(count) * add(x.magnitude())
    return Ends(-up_sum(error - add(x.lo)), up_sum(add(x.hi) + error))


def absolute_range(u: Ends) -> Ends:
    """The range of |x|."""
    inside = (u.lo < 0.0) & (u.hi > 0.0)
    size = np.minimum(np.abs(u.lo), np.abs(u.hi))
    return Ends(np.where(inside, 0.0, size), u.magnitude())


def whole_power(u: Ends, n: int) -> Ends:
    """Range of x**n, n >= 0."""
    if n == 0:
        return thin(np.ones(u.shape)).where(~np.isnan(u.lo))
    if n % 2 == 0:
        return _nonnegative_power(absolute_range(u), n)
    low, high = _nonnegative_power(thin(np.abs(u.lo)), n), _nonnegative_power(thin(np.abs(u.hi)), n)
    return Ends(np.where(u.lo < 0.0, -low.hi, low.lo), np.where(u.hi < 0.0, -high.lo, high.hi))


def _nonnegative_power(u: Ends, n: int) -> Ends:
    if n == 1:
        return u
    half = _nonnegative_power(u, n // 2)
    square = half._times(half)
    square = Ends(np.maximum(square.lo, 0.0), square.hi)
    product = square._times(u) if n % 2 else square
    return Ends(np.maximum(product.lo, 0.0), product.hi)


def accumulated(count: float) -> float:
    """Relative error of a sum of `count` products, against the sum of their sizes.

    gamma_n of Higham, Accuracy and Stability of Numerical Algorithms (2002), Section 3.1, enlarged for its own
    rounding.
    """
    return float((2.0 * count + 8.0) * EPS)


def bilinear(product: Callable[[Any, Any], Array], a: Any, b: Ends, count: float | None = None) -> Ends:
    """The range of sums of products (`matmul`, `einsum`), by middles and radii (Rump, BIT 39 (1999) 534-554).

    `product` has errors below `accumulated`. `count`: products per sum, if a is sparse.
    """
    # Thin intervals have no radii, which cost most for large matrices.
    (ma, ra), (mb, rb) = _middle_and_radius(a), _middle_and_radius(b)
    size_a, size_b = abs(ma), abs(mb)
    centre, sizes = product(ma, mb), product(size_a, size_b)
    if count is None:
        count = float(np.max(product(np.ones_like(ma[:1]), np.ones_like(mb[:1])), initial=1.0))
    radius = accumulated(count) * sizes
    if rb is not None and rb.any():
        radius = radius + product(size_a, rb)
    if ra is not None and ra.any():
        radius = radius + product(ra, size_b if rb is None else size_b + rb)
    radius = radius * (1.0 + accumulated(count)) + 4.0 * count * TINIEST
    if not sizes.all() and isinstance(a, Ends):
        # A zero sum of sizes is exact if products of nonzero entries do not underflow.
        least = [float(np.min(s, where=s > 0.0, initial=np.inf)) for s in (a.magnitude(), b.magnitude())]
        exact = least[0] * least[1] > 1e-290
        radius = np.where((sizes + radius == 4.0 * count * TINIEST) & exact, 0.0, radius)
    return Ends(-up_sum(radius - centre), up_sum(centre + radius))


def _middle_and_radius(x: Any) -> tuple[Any, Array | None]:
    if not isinstance(x, Ends) or x.lo is x.hi:
        return getattr(x, "lo", x), None
    middle = x.middle()
    return middle, x.radius(middle)


def sparse_product(matrix: Any, x: NumbersOrEnds) -> NumbersOrEnds:
    """A sparse matrix times vectors, shape (..., n)."""

    def times(entries: Any, v: Array) -> Array:
        return np.ascontiguousarray((entries @ v.reshape(-1, v.shape[-1]).T).T).reshape(*v.shape[:-1], -1)

    if not isinstance(x, Ends):
        return times(matrix, x)
    rows = matrix.tocsr()
    return bilinear(times, rows, x, float(np.diff(rows.indptr).max(initial=1)))
