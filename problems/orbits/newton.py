"""Newton's method for a periodic orbit."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.contraction import HALVING, Contraction, Iteration
from continuation.correctors.base import far_from_round_off
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import norm

ORBIT_NEWTON, ORBIT_FOUND, ORBIT_NEAR = Contraction(iterations=30, ratio=np.inf), 1e-13, 1e-7
"""First increments may grow; the last is below ORBIT_FOUND, or if they no longer halve below ORBIT_NEAR or round-off: a
component at rest may have the size of its round-off."""


def newton(homotopy: Any, u: Array, weights: Array, border: Array) -> Array:
    """The orbit's point (y, p) near u with the same product with `border`; `weights` measure increments.

    Raises `ArithmeticError` without convergence.
    """
    found, evaluator = Iteration(u, ORBIT_NEWTON), Evaluator(homotopy, Counts())

    def increment() -> Array:
        return evaluator.factor(found.x, border).solve(-evaluator.residual(found.x), 0.0)

    def done(size: float) -> bool:
        if size <= ORBIT_FOUND or found.ratio < HALVING:
            return size <= ORBIT_FOUND
        return size <= ORBIT_NEAR or not far_from_round_off(evaluator, found.x)

    with np.errstate(all="ignore"):
        if not found.run(increment, lambda step: norm(weights, step), done):
            raise ArithmeticError(f"Newton's method does not reach a periodic orbit near p = {u[-1]:.6g}")
    return found.x
