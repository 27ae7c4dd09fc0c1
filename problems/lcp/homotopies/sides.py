"""The pairs of a problem with bounds.

Each finite bound, lower ones first, has a force y and a distance, whose product is lambda c. In a box w = s - t.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.homotopies.cores import Pairs, larger_eliminated, parity, second_eliminated


@frozen(eq=False, slots=False)
class Sides:
    """The finite bounds."""

    problem: MixedLCP | LCP

    @cached_property
    def low(self) -> NDArray[np.intp]:
        """Indices with a lower bound."""
        return np.flatnonzero(self.problem.lower > -np.inf)

    @cached_property
    def high(self) -> NDArray[np.intp]:
        """Indices with an upper bound."""
        return np.flatnonzero(self.problem.upper < np.inf)

    @cached_property
    def index(self) -> NDArray[np.intp]:
        """The index of each pair."""
        return np.concatenate([self.low, self.high])

    @cached_property
    def sign(self) -> Array:
        """1 for lower bounds, -1 for upper ones."""
        return np.repeat([1.0, -1.0], [self.low.size, self.high.size])

    @cached_property
    def free(self) -> int | Array:
        """1 without bounds, else 0; shape (n,), or 0 if all have one."""
        free = np.bincount(self.index, minlength=self.problem.n) == 0
        return 1.0 * free if free.any() else 0

    def gaps(self, x: Array) -> Array:
        """Distances from the bounds."""
        if self.problem.standard:
            return x
        return np.concatenate([(x - self.problem.lower)[self.low], (self.problem.upper - x)[self.high]])

    def pull(self, v: Array) -> Array:
        """Changes of the distances for a change v of x, along the last axis."""
        return v if self.problem.standard else self.sign * v[..., self.index]

    def force(self, y: Array) -> Array:
        """The forces s - t on rows, shape (n,)."""
        return y if self.problem.standard else self._summed(self.sign * y)

    def _summed(self, values: Array) -> Array:
        # bincount of nothing gives integers.
        return np.multiply(1.0, np.bincount(self.index, values, self.problem.n))

    def eliminated(self, y: Array, gap: Array, larger: bool) -> Pairs | BoundPairs:
        """Keep dx of each index, or if `larger` a force that exceeds its distance."""
        if self.problem.standard:
            return (larger_eliminated if larger else second_eliminated)(y, gap)
        n = self.problem.n
        with np.errstate(all="ignore"):
            ratio = np.abs(y / gap)
            steepest = np.full(n, -np.inf)
            np.maximum.at(steepest, self.index, ratio)
            main = (ratio > 1.0) & (ratio == steepest[self.index]) & larger
            first = main & (self.sign > 0.0)
            main &= first | ~(self._summed(first) > 0.0)[self.index]
            swapped = self._summed(main)
            slope, inverse = np.where(main, 0.0, y / gap), np.where(main, 0.0, 1.0 / gap)
            a = np.where(swapped > 0.0, self._summed(np.where(main, -gap / y, 0.0)), 1.0)
            into_v = np.where(main, self.sign / y, 0.0)
        negative = np.count_nonzero(np.where(main, y, gap) < 0.0)
        total = self._summed(slope)
        pairs = negative + np.count_nonzero(main)
        return BoundPairs(self, a, swapped - total * a, parity(pairs), main, slope, inverse, into_v, total)


@frozen(eq=False)
class BoundPairs:
    """The pairs solved for one unknown per index, like `cores.Pairs`.

    An eliminated force has dy = inverse t - slope sign dx; `main` ones are kept.
    """

    sides: Sides
    a: Array
    b: Array
    sign: int
    main: NDArray[np.bool_]
    slope: Array
    inverse: Array
    into_v: Array
    total: Array

    def known(self, t: Array) -> tuple[Array, Array, Array]:
        """See `Pairs.known`."""
        sides = self.sides
        v = sides._summed(self.into_v * t)
        dy = self.inverse * t - self.slope * sides.pull(v)
        return v, sides.force(dy), dy

    def row(self, border: Array) -> Array:
        """Coefficients of k in border . dy."""
        sides = self.sides
        return sides._summed(border * sides.sign * np.where(self.main, 1.0, -self.slope * self.a[sides.index]))

    def of(self, k: Array, t: Array) -> tuple[Array, Array]:
        """(dx, dy)."""
        v, _, dy = self.known(t)
        kept = self.sides.sign * k[self.sides.index]
        return self.a * k + v, dy + np.where(self.main, kept, -self.slope * self.sides.pull(self.a * k))
