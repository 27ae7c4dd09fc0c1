"""The natural map of a problem whose q moves with t, as a homotopy with pieces: what a path of `along` satisfies."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP


@frozen(eq=False)
class NaturalMap:
    """x - mid(lower, x - w, upper), w = A x + q + t d; for a level, x less what t |x| shrinks x - w to.

    `problem`: Dense. `d` of shape (n,). `level`, of shape (n,): Where it is positive, unknowns without bounds pay t
    level_i |x_i|. `begin`, of shape (n + 1,): A point of the path.
    """

    problem: MixedLCP
    d: Array
    level: Array
    begin: Array = field(repr=False)

    def start(self) -> tuple[Array, float]:
        """The point of the path."""
        return self.begin[:-1], float(self.begin[-1])

    def residual(self, y: Array, lam: float) -> Array:
        """Zero on the path, shape (n,).

        `y` of shape (n,).
        """
        return self._off(y, self.problem.w(y) + lam * self.d, lam)

    def _off(self, y: Array, w: Array, lam: Any) -> Array:
        moved, width = y - w, lam * self.level
        kept = np.minimum(np.maximum(moved, -width), width)
        return np.where(self.level > 0.0, w + kept, self.problem.natural_map(y, w))

    def largest(self, u: Array) -> Array:
        """The largest component of the residual at many points, shape (m,).

        `u` of shape (m, n + 1).
        """
        y, lam = u[:, :-1], u[:, -1:]
        w = y @ self.problem.A.T + (self.problem.q + lam * self.d)
        found: Array = np.abs(self._off(y, w, lam)).max(axis=1, initial=0.0)
        return found

    def switches(self, y: Array, lam: float) -> Array:
        """X - w less its lower, and then its upper limits, those that there are.

        `y` of shape (n,).
        """
        moved = y - self.problem.w(y) - lam * self.d
        low, high = self._limits
        return np.concatenate([(moved - low[0] - lam * low[1])[low[2]], (moved - high[0] - lam * high[1])[high[2]]])

    def piece(self, signs: Array) -> Piece:
        """The equations where these signs hold.

        `signs` of shape (m,).
        """
        low, high = self._limits
        count = int(low[2].sum())
        below, above = np.zeros(self.d.size, dtype=bool), np.zeros(self.d.size, dtype=bool)
        below[low[2]], above[high[2]] = np.asarray(signs[:count]) < 0, np.asarray(signs[count:]) > 0
        levels = self.level > 0.0
        outside = np.where(levels, ~(below | above), below | above)
        value = np.where(levels, 0.0, np.where(below, low[0], np.where(above, high[0], 0.0)))
        slope = np.where(levels & below, -self.level, np.where(levels & above, self.level, 0.0))
        return Piece(self, outside, np.where(outside, value, 0.0), slope)

    @property
    def _limits(self) -> tuple[tuple[Array, Array, Array], tuple[Array, Array, Array]]:
        """The limits of x - w: at t = 0, their slopes, and where there are such."""
        levels = self.level > 0.0
        low, high = (np.where(levels, 0.0, end) for end in (self.problem.lower, self.problem.upper))
        return (low, -self.level, np.isfinite(low)), (high, self.level, np.isfinite(high))


@frozen(eq=False)
class Piece:
    """One piece: x_i is a bound, or zero, where it is `fixed`, and else w_i + t slope_i = 0."""

    whole: NaturalMap
    fixed: Array
    value: Array
    slope: Array

    def start(self) -> tuple[Array, float]:
        """That of the whole."""
        return self.whole.start()

    def residual(self, y: Array, lam: float) -> Array:
        """Linear.

        `y` of shape (n,).
        """
        w = self.whole.problem.w(y) + lam * (self.whole.d + self.slope)
        return np.where(self.fixed, y - self.value, w)

    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """Constant.

        `y` of shape (n,).
        """
        n = y.size
        by_y = np.where(self.fixed[:, None], np.eye(n), self.whole.problem.A)
        return by_y, np.where(self.fixed, 0.0, self.whole.d + self.slope)
