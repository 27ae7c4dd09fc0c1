"""The bordered system of a curve, solved with a factorisation that has H_y in it and a handful of numbers besides."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem, SingularError, factor_bordered


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
