"""A curve's equations at one point."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.curves.calculus import Calculus
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.linear import BorderedSystem
from continuation.linear.elimination import eliminated
from continuation.linear.system import Solver


@frozen(eq=False, slots=False)
class CurvePoint:
    """Values and derivatives of a curve at a point `u` = (y, lam).

    `gradients` makes the `rows` of the k conditions in `values`; `factored` the `base`, factors of [[H_y, b], [c', d]].
    `column`, (N, k - 1): derivative of H by the additional unknown, `hidden` if the last row gives it. `signs`:
    functions that change sign at degenerate points.
    """

    calculus: Calculus
    u: Array
    mu: float
    values: Array
    gradients: Callable[[], Array]
    factored: Callable[[], BorderedSystem]
    column: Array
    hidden: float | None = None
    signs: Mapping[str, Callable[[CurvePoint], float]] = field(factory=dict)

    @cached_property
    def rows(self) -> Array:
        """Gradients over (y, lam), additional unknown, and mu, shape (k, N + 1 + k)."""
        return self.gradients()

    @cached_property
    def base(self) -> BorderedSystem:
        """The factorisation."""
        return self.factored()

    @cached_property
    def evaluator(self) -> Evaluator:
        """The member's evaluator."""
        return self.calculus.evaluator(self.mu)

    @cached_property
    def apply(self) -> Callable[[Array], Array]:
        """The map v -> H' v, or EvaluationError without `differential`."""
        apply = self.evaluator.differential(self.u)
        if apply is None:
            raise EvaluationError("the family has a factorisation of its own and no `differential`")
        return apply

    @cached_property
    def by_parameter(self) -> Array:
        """H_mu, shape (N,)."""
        return self.calculus.by_parameter(self.u, self.mu)

    @cached_property
    def _rows(self) -> tuple[Array, Array | None]:
        rows, n = self.rows, self.u.size
        if self.hidden is None:
            return rows, None
        return np.delete(rows[:1], n, axis=1), -np.delete(rows[1], n)

    def residual(self) -> Array:
        """The equations."""
        H = self.evaluator.residual(self.u)
        return np.append(H if self.hidden is None else H + self.column[:, 0] * self.hidden, self.values)

    def times(self, v: Array) -> Array:
        """The derivative times a direction."""
        n, (rows, follows) = self.u.size, self._rows
        beside = v[n:-1] if follows is None else np.array([follows @ v])
        H = self.apply(v[:n]) + self.column @ beside + v[-1] * self.by_parameter
        return np.append(H, rows @ v)

    def bordered(self, border: Array) -> BorderedSystem:
        """Bordered derivative, by elimination of y.

        With the member's factors of F = [[H_y, b], [c', d]] and a new unknown sigma, the equations are F (y, s) = (r,
        sigma), s = 0, conditions and border.
        """
        base, n, hidden = self.base, self.u.size, self.hidden is not None
        columns = np.column_stack([self.apply(np.append(np.zeros(n - 1), 1.0)), self.column, self.by_parameter])
        below = np.vstack([self.rows, np.insert(border, n, 0.0) if hidden else border])

        def first(rhs: Array) -> Array:
            return base.solve(rhs[:-1], float(rhs[-1]))

        W = np.column_stack([-first(np.append(np.zeros(n - 1), 1.0)), *(first(np.append(p, 0.0)) for p in columns.T)])
        # Insert the columns of s and sigma, and the row s = 0.
        rows = np.insert(np.insert(below, n - 1, np.zeros((2, 1)), axis=1), 0, np.arange(len(below[0]) + 2) == n - 1, 0)
        whole = eliminated(first, W, rows)

        def solve(r: Array, rho: float) -> Array:
            z = whole.solve(np.concatenate([r[: n - 1], [0.0, 0.0], r[n - 1 :], np.zeros(int(hidden)), [rho]]))
            z = np.concatenate([z[: n - 1], z[n + 1 :]])
            return np.delete(z, -2) if hidden else z

        return Solver(solve, lambda: base.sign * whole.sign)
