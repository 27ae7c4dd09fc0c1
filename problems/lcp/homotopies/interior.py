"""What interior paths have in common: the ratio test, the relative metric, and the numbers worth watching."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import cmp_using, field, frozen

from continuation.arguments.checks import POSITIVE_FINITE
from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP

LARGEST_FALL = 1e-3
"""A component counts at least as this share of its size one step before, so that an end at zero has a metric too."""

INVERTIBLE = 1e-150
"""Sizes below this count as this: its square can still be inverted."""


@frozen
class RelativeMetric:
    """The mean square of relative changes, plus the square of the parameter's change.

    ``|v|^2 = (1/N) sum_i (v_i / u_i)^2 + lam v_{N+1}^2`` for N unknowns, anew at each point: interior paths live in
    orders of magnitude. The mean makes the step length independent of n; the sum takes about a tenth more steps.

    `lam`: The parameter's weight. `lower`, `upper`, of shape (n,): Bounds of the first n unknowns, which change
    relative to their distances from the nearer one; without any bound relative to themselves, but at least to `unit`.
    Default: zero, for all unknowns.
    """

    lam: float = field(default=1.0, validator=POSITIVE_FINITE)
    lower: Array | None = field(default=None, eq=cmp_using(eq=np.array_equal))
    upper: Array | None = field(default=None, eq=cmp_using(eq=np.array_equal))
    unit: float = 1.0

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """1/(N u_i^2), and `lam` for the parameter."""
        n = u.size - 1
        size = np.maximum(np.abs(u), INVERTIBLE)
        if self.lower is not None and self.upper is not None:
            x = u[: self.lower.size]
            distance = np.minimum(x - self.lower, self.upper - x)
            relative = np.where(np.isfinite(distance), np.abs(distance), np.maximum(np.abs(x), self.unit))
            size[: self.lower.size] = np.maximum(relative, INVERTIBLE)
        if current is not None:
            # The size one step before is 1 / sqrt(n current).
            np.maximum(size, LARGEST_FALL / np.sqrt(n * current), out=size)
        weights: Array = 1.0 / (n * size * size)
        weights[-1] = self.lam
        return weights


class OwnMetric:
    """The metric of a homotopy: of one class, but with the bounds of its problem where there are any."""

    def __get__(self, homotopy: Any, owner: type) -> RelativeMetric:
        """`own_metric`, of the class the metric of an LCP."""
        return RelativeMetric() if homotopy is None else homotopy.own_metric


def longest_step(value: Array, direction: Array) -> float:
    """The largest h, or inf, with ``value + t direction > 0`` for all t in [0, h), by components."""
    falling = direction < 0.0
    if not falling.any():
        return np.inf
    with np.errstate(over="ignore"):
        return max(0.0, float((value[falling] / -direction[falling]).min()))


def observed(problem: MixedLCP, x: Array) -> dict[str, float]:
    """The natural residual and the gap x'w; with bounds the distance to that to which w_i points in place of x_i."""
    w = problem.w(x)
    distance = x
    if not problem.standard:
        distance = np.where(w > 0.0, x - problem.lower, x - problem.upper)
        distance = np.where(np.isfinite(distance), distance, 0.0)
    return {"natural_residual": float(np.abs(problem.natural_map(x, w)).max()), "gap": float(distance @ w)}


def convolved(a: Array, b: Array, k: int) -> Array:
    """``sum_{j=1..k-1} a_j b_{k-j}``, shape (n,): what is known of coefficient k of a product of two series."""
    return np.asarray(np.einsum("jn,jn->n", a[1:k], b[k - 1 : 0 : -1]))
