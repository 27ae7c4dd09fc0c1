"""The natural map of a problem whose q moves with t, as a homotopy with pieces: what a path of `along` satisfies."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.lcp.parametric.stairs import Stairs


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
        """How far x - w is from the lower corner of each pair, and then from the upper one, where there is one.

        `y` of shape (n,).
        """
        moved, stairs = y - self.problem.w(y) - lam * self.d, self.stairs
        off: Array = moved - stairs.corner_x + lam * stairs.corner_slope
        return off[np.isfinite(stairs.corner_x)]

    def piece(self, signs: Array) -> Piece:
        """The equations where these signs hold.

        `signs` of shape (m,).
        """
        stairs, every = self.stairs, np.arange(self.d.size)
        side = np.zeros(stairs.corner_x.shape)
        side[np.isfinite(stairs.corner_x)] = signs
        row = 1 + (side[1] > 0.0) - (side[0] < 0.0)
        return Piece(self, ~stairs.moves_x[row, every], stairs.values[0, row, every], -stairs.values[1, row, every])

    @property
    def stairs(self) -> Stairs:
        """The graph of each pair."""
        return Stairs.of(self.problem, self.level)


@frozen(eq=False)
class Piece:
    """One piece: x_i is `value_i` where it is `fixed`, and else w_i + t slope_i = 0."""

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
