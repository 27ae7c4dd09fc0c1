"""Block elimination for [[A, P], [R, S]] with factors of A: W = A^-1 P, Schur complement S - R W."""

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
    """Factors of [[A, P], [R, S]]; `first` solves with A, `small` with the Schur complement; `sign`: of det `schur`."""

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
        return np.concatenate([x - self.W.dot(q), q])


def eliminated(first: Callable[[Array], Array], W: Array, rows: Array) -> Elimination:
    """Factors of [[A, P], [R, S]] from a solver `first` of A, W = A^-1 P and the rows [R, S], (k, n + k).

    `SingularError` if a Schur complement of order k > 1 is singular; for k = 1 solutions are then infinite.
    """
    R, S = np.split(rows, [len(W)], axis=1)
    schur = S - R @ W
    if len(schur) == 1:
        return Elimination(first, W, R, schur, lambda r: r / schur[0], 1 if schur[0, 0] > 0.0 else -1)
    small = factor_dense(schur[:-1, :-1], schur[:-1, -1], schur[-1])
    return Elimination(first, W, R, schur, lambda r: small.solve(r[:-1], float(r[-1])), small.sign)


@frozen(eq=False, slots=False)
class BlockElimination:
    """A bordered system, solved by factors of a well-conditioned H_y."""

    bordered: BorderedMatrix
    factor: Factored
    elimination: Elimination
    factor_whole: Callable[[], BorderedSystem]

    @property
    def sign(self) -> int:
        """Sign of det M."""
        return self.factor.sign * self.elimination.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The solution, shape (N + 1,); if elimination is inaccurate, by factors of the bordered matrix."""
        z, accurate = refined(self.bordered, self.elimination.solve, join(r, rho))
        return z if accurate else self._whole.solve(r, rho)

    def approximate(self, r: Array, rho: float) -> Array:
        """Solve without refinement."""
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
    """Factor H_y and border it; near a fold factor the bordered matrix. `SingularError` if singular or not finite.

    One refinement of ``w = H_y^{-1} H_lam`` shows how singular H_y is, in any units. Within TRUSTED the signs in ``det
    M = det H_y * schur`` are certain (Govaerts, Numerical Methods for Bifurcations, SIAM 2000, section 3).
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
