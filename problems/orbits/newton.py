"""Newton's method for a periodic orbit."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.contraction import HALVING, Contraction, Iteration
from continuation.linear import factor_bordered
from continuation.metric import norm

ORBIT_NEWTON, ORBIT_FOUND, ORBIT_NEAR = Contraction(iterations=30, ratio=np.inf), 1e-13, 1e-7
"""First increments may grow; the last is below ORBIT_FOUND, or below ORBIT_NEAR if they no longer halve."""


def newton(homotopy: Any, u: Array, weights: Array, border: Array) -> Array:
    """The point (y, p) of an orbit near u with the same product with `border`.

    Raises `ArithmeticError` without convergence.
    """
    found = Iteration(u, ORBIT_NEWTON)

    def increment() -> Array:
        y, lam = found.x[:-1], float(found.x[-1])
        matrix, column = homotopy.jacobian(y, lam)
        return factor_bordered(matrix, column, border).solve(-homotopy.residual(y, lam), 0.0)

    def done(size: float) -> bool:
        return size <= ORBIT_FOUND or (size <= ORBIT_NEAR and found.ratio >= HALVING)

    with np.errstate(all="ignore"):
        if not found.run(increment, lambda step: norm(weights, step), done):
            raise ArithmeticError(f"Newton's method does not reach a periodic orbit near p = {u[-1]:.6g}")
    return found.x
