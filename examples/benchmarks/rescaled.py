"""A homotopy in other units: E H((y - c) / D, (lam - b) / a), with positive D, E and a."""

from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array


@frozen(eq=False)
class Rescaled:
    """A homotopy's path in other units: y = D y0 + c, lam = a lam0 + b, and the equations multiplied by E."""

    homotopy: Any
    D: Array | float = 1.0
    c: Array | float = 0.0
    E: Array | float = 1.0
    a: float = 1.0
    b: float = 0.0

    @property
    def target(self) -> float | None:
        """The homotopy's, in these units."""
        target = getattr(self.homotopy, "target", 0.0)
        return None if target is None else self.a * target + self.b

    def start(self) -> tuple[Array, float]:
        """The homotopy's start, in these units."""
        y, lam = self.homotopy.start()
        return self.D * np.asarray(y) + self.c, self.a * lam + self.b

    def residual(self, y: Array, lam: float) -> Array:
        """E H."""
        scaled: Array = self.E * self.homotopy.residual((y - self.c) / self.D, (lam - self.b) / self.a)
        return scaled

    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """Dense, whatever the homotopy's is."""
        H_y, H_lam = self.homotopy.jacobian((y - self.c) / self.D, (lam - self.b) / self.a)
        return np.reshape(self.E, (-1, 1)) * (H_y @ np.eye(y.size)) / self.D, self.E * np.asarray(H_lam) / self.a

    def original(self, u: Array) -> Array:
        """A point (y, lam) in the units of the homotopy."""
        return np.append((u[:-1] - self.c) / self.D, (u[-1] - self.b) / self.a)


def rescaled(homotopy: Any, extent: Array, generator: np.random.Generator) -> Rescaled:
    """In units of 1e-8 to 1e8 of the problem's, at random, with zero 1e-2 to 1e6 of the path's extent away."""
    n = extent.size - 1
    D, E = (10.0 ** generator.uniform(-8.0, 8.0, n) for _ in range(2))
    a = float(10.0 ** generator.uniform(-8.0, 8.0))
    c = D * extent[:-1] * generator.standard_normal(n) * 10.0 ** generator.uniform(-2.0, 6.0)
    b = a * float(extent[-1] * generator.standard_normal() * 10.0 ** generator.uniform(-2.0, 6.0))
    return Rescaled(homotopy, D, c, E, a, b)
