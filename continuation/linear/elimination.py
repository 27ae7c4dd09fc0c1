"""Block elimination: a matrix with k columns and rows more, by the factors of the matrix alone.

[[A, P], [R, S]] with W = A^-1 P has the Schur complement S - R W, of order k, and the determinant det A det(S - R W).
With H_y for A and k = 1 this is the bordered system of a structured matrix, refined; where H_y is too near to singular
for that, the whole matrix is factored instead.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.linear.dense import factor_dense
from continuation.linear.refine import TRUSTED, BorderedMatrix, Factored, join, refined
from continuation.linear.silence import without_warnings
from continuation.linear.system import BorderedSystem


@frozen(eq=False)
class Elimination:
    """[[A, P], [R, S]], with A factored.

    `first`: Solves with A. `W`, of shape (n, k): A^-1 P. `R` of shape (k, n). `schur` of shape (k, k). `small`, `sign`:
    Solves with it, and the sign of its determinant.
    """

    first: Callable[[Array], Array]
    W: Array
    R: Array
    schur: Array
    small: Callable[[Array], Array]
    sign: int

    def solve(self, rhs: Array) -> Array:
        """The solution, shape (n + k,)."""
        n = len(self.W)
        x = self.first(rhs[:n])
        q = self.small(rhs[n:] - self.R.dot(x))
        z = np.empty(rhs.size)
        z[:n] = x - self.W.dot(q)
        z[n:] = q
        return z


def eliminated(first: Callable[[Array], Array], W: Array, rows: Array) -> Elimination:
    """Border A by columns, given as W = A^-1 P, and by rows [R, S], shape (k, n + k).

    Raises `SingularError` if the whole is singular, and k > 1.
    """
    R, S = np.split(rows, [len(W)], axis=1)
    schur = S - R @ W
    if len(schur) == 1:
        return Elimination(first, W, R, schur, lambda r: r / schur[0], 1 if schur[0, 0] > 0.0 else -1)
    small = factor_dense(schur[:-1, :-1], schur[:-1, -1], schur[-1])
    return Elimination(first, W, R, schur, lambda r: small.solve(r[:-1], float(r[-1])), small.sign)


@frozen(eq=False, slots=False)
class BlockElimination:
    """The bordered system, solved with a factorisation of H_y that is far from singular."""

    bordered: BorderedMatrix
    factor: Factored
    elimination: Elimination
    factor_whole: Callable[[], BorderedSystem]

    @property
    def sign(self) -> int:
        """Sign of det M."""
        return self.factor.sign * self.elimination.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, shape (N + 1,); by the factorisation of the whole where elimination is not accurate."""
        z, accurate = refined(self.bordered, self.elimination.solve, join(r, rho))
        return z if accurate else self._whole.solve(r, rho)

    def approximate(self, r: Array, rho: float) -> Array:
        """The same without measuring the residual: for an iteration that measures its own."""
        return self.elimination.solve(join(r, rho))

    @cached_property
    def _whole(self) -> BorderedSystem:
        return self.factor_whole()


@without_warnings(all="ignore")
def eliminate(
    matrix: Matrix,
    column: Array,
    row: Array,
    factor: Callable[[Any], Factored | None],
    whole: Callable[[], BorderedSystem],
) -> BorderedSystem:
    """Factor H_y and border it; near a fold, where H_y is useless, factor the whole matrix instead.

    One refinement of ``w = H_y^{-1} H_lam`` shows how singular H_y is to this factorisation: at a fold w is round-off.
    The test depends on no norm, and so on no scaling. Within its limits both signs in ``det M = det H_y * schur`` are
    certain; beyond them neither is, though their product is well determined, and only the whole matrix tells it.

    Raises `SingularError` if the bordered matrix is exactly singular, or an entry is not finite.

    References
    ----------
    W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000, section 3.
    """
    bordered = BorderedMatrix.of(matrix, column, row)
    factors = factor(matrix)
    if factors is None:
        return whole()
    w = factors.solve(column)
    correction = factors.solve(column - matrix @ w)
    w = w + correction
    elimination = eliminated(factors.solve, w[:, None], row[None])
    trusted = np.abs(correction).max() <= TRUSTED * np.abs(w).max()
    trusted &= abs(float(elimination.schur[0, 0])) > TRUSTED * (abs(row[-1]) + np.abs(row[:-1]) @ np.abs(w))
    return BlockElimination(bordered, factors, elimination, whole) if trusted else whole()
