"""A curve's equations at one point: the residual, its derivative applied, as a matrix, and factored with a border."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from scipy.sparse.linalg import LinearOperator

from continuation.arrays import Array, Matrix
from continuation.curves.calculus import Calculus
from continuation.curves.local import Local
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.events.singularity import full_derivative
from continuation.linear import BorderedSystem, SingularError, factor_bordered
from continuation.linear.entries import extended


@frozen(eq=False, slots=False)
class Here:
    """All that is known of a curve at a point; worked out once.

    `u` of shape (N + 1,), `beside` of shape (0,) or (1,).
    """

    calculus: Calculus
    u: Array
    beside: Array
    mu: float
    local: Local

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
        rows, n = self.local.rows, self.u.size
        if self.local.hidden is None:
            return rows, None
        return np.delete(rows[:1], n, axis=1), -np.delete(rows[1], n)

    def residual(self) -> Array:
        """The equations."""
        hidden = self.local.hidden
        beside = self.beside if hidden is None else np.array([hidden])
        return np.concatenate([self.evaluator.residual(self.u) + self.local.column @ beside, self.local.values])

    def times(self, v: Array) -> Array:
        """The derivative applied to a direction."""
        n, (rows, follows) = self.u.size, self._rows
        beside = v[n:-1] if follows is None else np.array([follows @ v])
        H = self.apply(v[:n]) + self.local.column @ beside + v[-1] * self.by_parameter
        return np.concatenate([H, rows @ v])

    def matrices(self) -> tuple[Matrix, Array]:
        """The derivative by the unknowns, dense or sparse as the family's, and by mu.

        Where a number is hidden it is H' and a matrix of rank one: an operator, if H' is sparse.
        """
        full, (rows, follows) = full_derivative(self.evaluator, self.u), self._rows
        column = self.local.column
        last = np.append(self.by_parameter, rows[:, -1])
        if follows is not None:
            last[:-1] += column[:, 0] * follows[-1]
            if sp.issparse(full):
                order = self.u.size
                return LinearOperator((order, order), lambda v: self.times(np.append(v, 0.0)), dtype=float), last
            return np.vstack([full + column * follows[:-1], rows[:, :-1]]), last
        return extended(full, column, rows[:, :-1]), last

    def bordered(self, border: Array) -> BorderedSystem:
        """The derivative with a border, factored by elimination."""
        local, n = self.local, self.u.size
        columns = np.column_stack([self.apply(np.append(np.zeros(n - 1), 1.0)), local.column, self.by_parameter])
        hidden = local.hidden is not None
        last = np.insert(border, n, 0.0) if hidden else border
        return eliminated(local.base, columns, np.vstack([local.rows, last]), hidden)


@frozen(eq=False)
class Eliminated:
    """[[H_y, P], [G_y, G_p], [B_y, B_p]] of order N + m: P has the m columns of lam, the unknown beside, and mu.

    With F = [[H_y, b], [c', d]] factored, y and s follow from c'y + d s = sigma and p; s = 0, the conditions and the
    border are m + 1 equations in sigma and p, and det = det F times the determinant of these.

    `base`: F. `solved`, of shape (N + 1, m + 1): (y, s) that follow from sigma = 1, and from each of p. `rows`, of
    shape (m, N + m): The conditions and the border. `small`: The m + 1 equations. `hidden`: Whether the unknown beside
    follows from the others and is not asked for, nor the condition that it follows from.
    """

    base: BorderedSystem
    solved: Array
    rows: Array
    small: BorderedSystem
    hidden: bool

    @property
    def sign(self) -> int:
        """Sign of the determinant."""
        return self.base.sign * self.small.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, shape (N + m,), or (N + m - 1,) without what is hidden."""
        n, r = len(self.solved) - 1, np.append(r, 0.0) if self.hidden else r
        x = self.base.solve(r[:n], 0.0)
        left = np.append(r[n:], rho) - self.rows[:, :n] @ x[:n]
        q = self.small.solve(np.append(-x[n], left[:-1]), float(left[-1]))
        y = x[:n] + self.solved[:n] @ q
        z = np.concatenate([y, q[1:]])
        return np.delete(z, -2) if self.hidden else z


def eliminated(base: BorderedSystem, columns: Array, rows: Array, hidden: bool = False) -> Eliminated:
    """Eliminate y.

    `columns` of shape (N, m). `rows` of shape (m, N + m). `hidden`: As of `Eliminated`. Raises `SingularError` if the
    whole is singular.
    """
    n = len(columns)
    first = base.solve(np.zeros(n), 1.0)
    solved = np.column_stack([first, *(-base.solve(column, 0.0) for column in columns.T)])
    below = rows[:, :n] @ solved[:n]
    below[:, 1:] += rows[:, n:]
    matrix = np.vstack([solved[n], below])
    if not np.isfinite(matrix).all():
        raise SingularError("the bordered solution is not finite")
    return Eliminated(base, solved, rows, factor_bordered(matrix[:-1, :-1], matrix[:-1, -1], matrix[-1]), hidden)
