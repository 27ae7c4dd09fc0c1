"""The natural map along a path of `along`."""

from __future__ import annotations

import numpy as np
from attrs import field, frozen

from continuation import from_functions
from continuation.arrays import Array
from continuation.homotopy import Homotopy
from problems.lcp.data.problem import MixedLCP
from problems.lcp.parametric.stairs import Stairs


@frozen(eq=False)
class NaturalMap:
    """x - mid(lower, x - w, upper), w = Ax + q + t d; for a level, w + mid(-t level, x - w, t level).

    `d` and `level` are as for `along`; `begin`, of shape (n + 1,), is on the path.
    """

    problem: MixedLCP
    d: Array
    level: Array
    begin: Array = field(repr=False)

    def start(self) -> tuple[Array, float]:
        """The point of the path."""
        return self.begin[:-1], float(self.begin[-1])

    def residual(self, y: Array, lam: float) -> Array:
        """Zero on the path, shape (n,)."""
        found: Array = self.residuals(np.append(y, lam)[None])[0]
        return found

    def residuals(self, u: Array) -> Array:
        """Residuals of points u, shape (m, n + 1) to (m, n)."""
        y, lam = u[:, :-1], u[:, -1:]
        w = y @ self.problem.A.T + (self.problem.q + lam * self.d)
        width = lam * self.level
        kept = np.minimum(np.maximum(y - w, -width), width)
        return np.where(self.level > 0.0, w + kept, self.problem.natural_map(y, w))

    def switches(self, y: Array, lam: float) -> Array:
        """Distances of x - w from the finite lower, then upper corners."""
        stairs = Stairs.of(self.problem, self.level)
        off: Array = y - self.problem.w(y) - lam * self.d - stairs.corner_x + lam * stairs.corner_slope
        return off[np.isfinite(stairs.corner_x)]

    def piece(self, signs: Array) -> Homotopy:
        """The linear homotopy of the piece with these signs."""
        stairs = Stairs.of(self.problem, self.level)
        side = np.zeros(stairs.corner_x.shape)
        side[np.isfinite(stairs.corner_x)] = signs
        row, every = 1 + (side[1] > 0.0) - (side[0] < 0.0), np.arange(self.d.size)
        (fixed, slope), by_w = stairs.values[:2, row, every], stairs.moves_x[row, every]

        def residual(y: Array, lam: float) -> Array:
            w = self.problem.w(y) + lam * (self.d - slope)
            found: Array = np.where(by_w, w, y - fixed)
            return found

        return from_functions(residual, start=self.start())
