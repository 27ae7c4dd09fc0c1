"""Equations of curves with the null vector among the unknowns, without factorisations.

    H(y, lam; mu) = 0,   H_y v = 0,             |v| = 1                     (folds)
    H(y, lam; mu) = 0,   H_y v = i omega v,     c* v = 1,   v complex       (Hopf points)
    H(y, lam; mu) = 0,   [H_y, H_lam] t = 0,    |t| = 1,    g(y, lam, t) = 0    (a monitor g)

The systems are regular where the curve is (Seydel, Numer. Math. 33 (1979); Griewank and Reddien, IMA J. Numer. Anal. 3
(1983)). Dual numbers give derivatives along v. The curve is the projection on (y, lam, omega, mu).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.jets import derivative_along
from continuation.metric import Weighted

DECIMALS = 6
"""Decimals of c, since machines differ in later digits."""


@frozen(eq=False)
class WrittenOut:
    """The system, a homotopy in mu; its unknowns are the vector, in extents, then the curve's.

    `c`: complex, shape (N,), for Hopf points. `metric`: by the start's extents.
    """

    condition: Any
    first: Array
    c: Array | None
    metric: Weighted
    target: None = None

    @classmethod
    def of(cls, condition: Any, points: Array) -> WrittenOut:
        """The system for a path with rows `points`; c is nearest to all null vectors."""
        vectors, c = np.array([condition.null_vector(u) for u in points]), None
        if condition.beside:
            c = np.linalg.svd(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))[2][0]
            # c is unique up to a phase: make its largest entry real.
            largest = c[np.argmax(np.abs(c))]
            c = np.round(c * (largest.conj() / abs(largest)), DECIMALS)
        extent = condition.calculus.extent
        beside, far = np.abs(points[:, extent.size : -1]).max(axis=0), float(np.ptp(points[:, -1]))
        count = vectors.shape[1] * (1 if c is None else 2)
        sizes = np.concatenate([np.ones(count), extent, np.where(beside > 0.0, beside, 1.0)])
        return cls(condition, points[0], c, Weighted(sizes**-2.0, (far or 1.0) ** -2.0))

    def start(self) -> tuple[Array, float]:
        """The first point."""
        u = self.lifted(self.first, None)
        return u[:-1], float(u[-1])

    def lifted(self, u: Array, before: Array | None) -> Array:
        """A curve point with its vector in front, oriented like `before`."""
        v = self.condition.null_vector(u)
        if self.c is not None:
            v = v / np.vdot(self.c, v)
            return np.concatenate([v.real, v.imag, u])
        if before is not None and before[: v.size] @ v < 0.0:
            v = -v
        return np.concatenate([v, u])

    def residual(self, y: Any, lam: Any) -> Any:
        """The equations, for arrays of any kind."""
        calculus = self.condition.calculus
        extent, mu = calculus.extent, np.stack([lam])

        def along(U: Any, v: Any) -> Any:
            return derivative_along(calculus.residual, U, np.concatenate([v, np.zeros(extent.size + 1 - len(v))]))

        if self.c is None:
            count = len(y) - extent.size
            v, u = y[:count], y[count:]
            whole = extent[:count] * v
            parts = [*along(np.concatenate([u, mu]), whole), np.stack([np.sum(np.square(v)) - 1.0])]
            if count == extent.size:
                parts.append(np.stack([self.condition.function(np.concatenate([u, whole]))]))
            return np.concatenate(parts)
        n = extent.size - 1
        v, w, u, omega = y[:n], y[n : 2 * n], np.concatenate([y[2 * n : -1], mu]), y[-1]
        real, imaginary, a, b = extent[:-1] * v, extent[:-1] * w, self.c.real, self.c.imag
        H, first = along(u, real)
        second = along(u, imaginary)[1]
        norm = [np.sum(a * v + b * w) - 1.0, np.sum(a * w - b * v)]
        return np.concatenate([H, first + omega * imaginary, second - omega * real, np.stack(norm)])
