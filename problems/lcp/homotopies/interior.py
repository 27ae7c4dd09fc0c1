"""The common form of the homotopies: linear rows go from `origin` to `goal`, products p q + plain from c to 0.

    ((1 - lam) goal + lam origin, p q + plain - lam c)

`parts` defines goal, origin, p, q and plain, affine in u = (y, lam); c is the value of p q + plain at the start.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from attrs import cmp_using, field, frozen

from continuation.arguments.checks import POSITIVE_FINITE
from continuation.arrays import Array, Matrix
from continuation.metric import INVERTIBLE
from continuation.point.linearization import Linearization
from problems.lcp.homotopies.cores import in_full
from problems.lcp.homotopies.quadratics import exact_end, form
from problems.lcp.quadratic.engine import ByProducts
from problems.options import quiet

Parts: TypeAlias = "tuple[Array, Array, Array, Array, Array | float]"
"""(goal, origin, p, q, plain) at a point; without constants for a direction."""

LARGEST_FALL = 1e-3
"""Largest fall of a scale per step, as ends at zero need a metric."""


@frozen
class RelativeMetric:
    """The mean square of relative changes, plus the parameter's.

    ``|v|^2 = (1/N) sum_i (v_i/u_i)^2 + lam v_{N+1}^2``; the mean makes step lengths independent of n. The scale of the
    first n unknowns is the distance from the nearer bound (`lower`, `upper`, default zero), or without bounds their
    size, at least `unit`.
    """

    lam: float = field(default=1.0, validator=POSITIVE_FINITE)
    lower: Array | None = field(default=None, eq=cmp_using(eq=np.array_equal))
    upper: Array | None = field(default=None, eq=cmp_using(eq=np.array_equal))
    unit: float = 1.0

    def sizes(self, u: Array) -> Array:
        """The scales of u."""
        size: Array = np.abs(u)
        if self.lower is not None and self.upper is not None:
            n = self.lower.size
            distance = np.abs(np.minimum(u[:n] - self.lower, self.upper - u[:n]))
            size[:n] = np.where(np.isfinite(distance), distance, np.maximum(size[:n], self.unit))
        return size

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """1/(N u_i^2), and `lam` for the parameter."""
        n, size = u.size - 1, np.maximum(self.sizes(u), INVERTIBLE)
        if current is not None:
            # The last step's size is 1 / sqrt(n current).
            np.maximum(size, LARGEST_FALL / np.sqrt(n * current), out=size)
        weights: Array = 1.0 / (n * size * size)
        weights[-1] = self.lam
        return weights


class OwnMetric:
    """The attribute `metric`: a homotopy's `own_metric`; on its class, an LCP's."""

    def __get__(self, homotopy: Any, owner: type) -> RelativeMetric:
        return RelativeMetric() if homotopy is None else homotopy.own_metric


@frozen(eq=False, slots=False)
class System:
    """H' of the homotopy `of` at a point."""

    of: Any
    y: Array
    lam: float
    parts: Parts

    @classmethod
    def at(cls, homotopy: Any, y: Array, lam: float) -> System:
        """H' of a homotopy at a point; y is copied."""
        return cls(homotopy, y.copy(), lam, homotopy.parts(y.copy(), lam))

    def apply(self, v: Array) -> Array:
        """H' v."""
        (goal, origin, p, q, _), l = self.parts, v[-1]
        to_goal, to_origin, dp, dq, plain = self.of.parts(v[:-1], l, 0.0)
        rows = (1.0 - self.lam) * to_goal + self.lam * to_origin + (origin - goal) * l
        return np.concatenate([rows, p * dq + q * dp + plain - self.of.c * l])

    @cached_property
    def column(self) -> Array:
        """H_lam, shape (N,)."""
        return self.apply(np.eye(1, self.y.size + 1, self.y.size)[0])

    @property
    def sizes(self) -> Array:
        """The scales of y."""
        sizes: Array = self.of.metric.sizes(self.y)
        return sizes


@quiet
def residual(self: Any, y: Array, lam: float) -> Array:
    """The residual H(y, lam)."""
    goal, origin, p, q, plain = self.parts(y, lam)
    return np.concatenate([(1.0 - lam) * goal + lam * origin, p * q + plain - lam * self.c])


def jacobian(self: Any, y: Array, lam: float) -> tuple[Matrix, Array]:
    """(H_y, H_lam) in full, for reference."""
    return in_full(System.at(self, y, lam).apply, y.size, self.problem.sparse)


@quiet
def differential(self: Any, y: Array, lam: float, v: Array) -> Array:
    """H' v."""
    return System.at(self, y, lam).apply(v)


@quiet
def taylor(self: Any, point: Linearization, order: int) -> Array:
    """Taylor coefficients in the pseudo-arclength of `point`, one a row.

    Each takes one solve and two products with A (Cochelin's asymptotic numerical method).
    """
    n, size = self.n, point.u.size - 1
    c = np.zeros((order + 1, size + 1))
    c[0] = point.u
    c[1:2] = point.tangent
    first, second = np.zeros((2, order + 1, size))
    for k in range(2, order + 1):
        goal, origin, first[k - 1, n:], second[k - 1, n:], _ = self.parts(c[k - 1, :-1], c[k - 1, -1], 0.0)
        first[k - 1, :n], second[k - 1, :n] = c[k - 1, -1], origin - goal
        c[k] = point.solve(-np.einsum("jn,jn->n", first[1:k], second[k - 1 : 0 : -1]))
    return c


def proof_engine(self: Any) -> ByProducts:
    """Form of H for path proofs."""
    return ByProducts(form(self))


def certify_end(self: Any, y: Array) -> str:
    """A sentence on the exact solution near x, or "".

    Parameters
    ----------
    y : ndarray
        The end of a path.
    """
    return exact_end(self.problem, y[: self.n])


def max_step(self: Any, u: Array, v: Array) -> float:
    """How far along v a factor of the pairs vanishes, or inf."""
    factors, changes = np.array([self.parts(u[:-1], u[-1])[2:4], self.parts(v[:-1], v[-1], 0.0)[2:4]]) * self.signs
    falling = changes < 0.0
    if not falling.any():
        return np.inf
    with np.errstate(over="ignore"):
        return max(0.0, float((factors[falling] / -changes[falling]).min()))


def observe(self: Any, y: Array, lam: float) -> dict[str, float]:
    """The natural residual and the gap x'w at x; with bounds, distances replace x."""
    problem, x = self.problem, y[: self.n]
    w = problem.w(x)
    distance = np.where(w > 0.0, x - problem.lower, x - problem.upper)
    distance = np.where(np.isfinite(distance), distance, 0.0) if not problem.standard else x
    return {"natural_residual": float(np.abs(problem.natural_map(x, w)).max()), "gap": float(distance @ w)}
