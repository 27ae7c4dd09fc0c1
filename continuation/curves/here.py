"""A curve's equations at one point: the residual, its derivative applied, as a matrix, and factored with a border."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from scipy.sparse.linalg import LinearOperator

from continuation.arrays import Array, Matrix
from continuation.curves.calculus import Calculus
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.events.singularity import full_derivative
from continuation.linear import BorderedSystem
from continuation.linear.elimination import eliminated
from continuation.linear.entries import extended
from continuation.linear.system import Solver


@frozen(eq=False, slots=False)
class Here:
    """All that is known of a curve at a point; what a residual does not need is worked out when it is asked for.

    `u`, of shape (N + 1,): (y, lam). `values`, of shape (k,): What is to vanish. `gradients`: Makes `rows`. `factored`:
    Makes `base`: [[H_y, b], [c', d]] for some border, factored. `column`, of shape (N, k - 1): Derivative of the
    equations H = 0 by the unknown beside. `hidden`: The unknown beside where it is none, but a number that is added to
    H along the column: the last of the rows is how it follows from the others. `signs`: Numbers whose signs tell
    degenerate points, from the rows.
    """

    calculus: Calculus
    u: Array
    mu: float
    values: Array
    gradients: Callable[[], Array]
    factored: Callable[[], BorderedSystem]
    column: Array
    hidden: float | None = None
    signs: Mapping[str, Callable[[Array], float]] = field(factory=dict)

    @cached_property
    def rows(self) -> Array:
        """Gradients over (y, lam), the unknown beside them if there is one, and mu: shape (k, N + 1 + k)."""
        return self.gradients()

    @cached_property
    def base(self) -> BorderedSystem:
        """The factorisation."""
        return self.factored()

    @cached_property
    def evaluator(self) -> Evaluator:
        """Of the family's member."""
        return self.calculus.evaluator(self.mu)

    @cached_property
    def apply(self) -> Callable[[Array], Array]:
        """The map v -> H' v of the member; EvaluationError where that has a factorisation and no `differential`."""
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
        """Gradients of what vanishes, and of the unknown that is hidden, over those that are not."""
        rows, n = self.rows, self.u.size
        if self.hidden is None:
            return rows, None
        return np.delete(rows[:1], n, axis=1), -np.delete(rows[1], n)

    def residual(self) -> Array:
        """The equations."""
        H = self.evaluator.residual(self.u)
        return np.append(H if self.hidden is None else H + self.column[:, 0] * self.hidden, self.values)

    def times(self, v: Array) -> Array:
        """The derivative applied to a direction."""
        n, (rows, follows) = self.u.size, self._rows
        beside = v[n:-1] if follows is None else np.array([follows @ v])
        H = self.apply(v[:n]) + self.column @ beside + v[-1] * self.by_parameter
        return np.append(H, rows @ v)

    def matrices(self) -> tuple[Matrix, Array]:
        """The derivative by the unknowns, dense or sparse as the family's, and by mu.

        Where a number is hidden it is H' and a matrix of rank one: an operator, if H' is sparse.
        """
        full, (rows, follows) = full_derivative(self.evaluator, self.u), self._rows
        column = self.column
        last = np.append(self.by_parameter, rows[:, -1])
        if follows is not None:
            last[:-1] += column[:, 0] * follows[-1]
            if sp.issparse(full):
                order = self.u.size
                return LinearOperator((order, order), lambda v: self.times(np.append(v, 0.0)), dtype=float), last
            return np.vstack([full + column * follows[:-1], rows[:, :-1]]), last
        return extended(full, column, rows[:, :-1]), last

    def bordered(self, border: Array) -> BorderedSystem:
        """The derivative with a border, by elimination of y.

        The member's own factors are of F = [[H_y, b], [c', d]]. With a further unknown sigma the equations are those of
        F (y, s) = (r, sigma), s = 0, the conditions and the border: four blocks, of which F is the first.
        """
        base, n, hidden = self.base, self.u.size, self.hidden is not None
        columns = np.column_stack([self.apply(np.append(np.zeros(n - 1), 1.0)), self.column, self.by_parameter])
        below = np.vstack([self.rows, np.insert(border, n, 0.0) if hidden else border])

        def first(rhs: Array) -> Array:
            return base.solve(rhs[:-1], float(rhs[-1]))

        W = np.column_stack([-first(np.append(np.zeros(n - 1), 1.0)), *(first(np.append(p, 0.0)) for p in columns.T)])
        # Behind the unknowns y, the columns of s and sigma; above the conditions, the row s = 0.
        rows = np.insert(np.insert(below, n - 1, np.zeros((2, 1)), axis=1), 0, np.arange(len(below[0]) + 2) == n - 1, 0)
        whole = eliminated(first, W, rows)

        def solve(r: Array, rho: float) -> Array:
            z = whole.solve(np.concatenate([r[: n - 1], [0.0, 0.0], r[n - 1 :], np.zeros(int(hidden)), [rho]]))
            z = np.concatenate([z[: n - 1], z[n + 1 :]])
            # What is hidden follows from the others.
            return np.delete(z, -2) if hidden else z

        return Solver(solve, lambda: base.sign * whole.sign)
