"""Iterative refinement with row-wise residuals."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from attrs import frozen

from continuation.arrays import EPS, SIX_DIGITS, Array, Matrix
from continuation.linear.silence import without_warnings
from continuation.linear.system import SingularError

REFINEMENTS = 2
"""Corrections per solve; each gains the digits of TRUSTED."""

BACKWARD_ERROR = 16 * EPS
"""Row-wise backward error that counts as round-off."""

TRUSTED = SIX_DIGITS
"""Largest relative error of H_y^{-1} H_lam, and least relative Schur complement, for elimination: a refinement gains
six digits, signs are certain."""


class Factored(Protocol):
    """A factorisation of a square matrix A."""

    @property
    def sign(self) -> int:
        """Sign of det A, +1 or -1."""
        ...

    def solve(self, rhs: Array) -> Array:
        """The solution, shape (N,); `rhs` is kept."""
        ...


@frozen(eq=False)
class BorderedMatrix:
    """``M = [[A, column], [row']]``, to measure residuals with."""

    matrix: Matrix
    column: Array
    row: Array
    row_sums: Array
    """Row sums of |A|, or a bound, shape (N,)."""

    def __attrs_post_init__(self) -> None:
        for name, entries in (("H_y", self.row_sums), ("H_lam", self.column), ("border", self.row)):
            if not np.isfinite(entries).all():
                raise SingularError(f"The bordered matrix cannot be factored: {name} has an entry that is not finite.")

    @classmethod
    def of(cls, matrix: Matrix, column: Array, row: Array) -> BorderedMatrix:
        """The matrix with row sums of ``abs(matrix)``."""
        with np.errstate(over="ignore"):
            return cls(matrix, column, row, abs(matrix) @ np.ones(len(column)))

    def times(self, z: Array) -> Array:
        """``M z``, shape (N + 1,)."""
        return -self.residual(z, np.zeros(len(z)))

    def residual(self, z: Array, rhs: Array) -> Array:
        """``rhs - M z``, shape (N + 1,)."""
        gap = rhs.copy()
        gap[:-1] -= self.matrix @ z[:-1]
        gap[:-1] -= self.column * z[-1]
        gap[-1] -= self.row.dot(z)
        return gap

    def negligible(self, gap: Array, z: Array, rhs: Array) -> bool:
        """Whether the residual `gap` of `z` is round-off in each row, in any units (Oettli & Prager 1964)."""
        largest = np.abs(z[:-1]).max()
        size = np.abs(rhs)
        size[:-1] += self.row_sums * largest + np.abs(self.column * z[-1])
        size[-1] += np.abs(self.row[:-1]).sum() * largest + abs(self.row[-1] * z[-1])
        return bool((np.abs(gap) <= BACKWARD_ERROR * size).all())


def join(r: Array, rho: float) -> Array:
    """(r, rho) in one new array."""
    return np.concatenate([r, (rho,)], dtype=float)


@without_warnings(all="ignore")
def refined(bordered: BorderedMatrix, solve: Callable[[Array], Array], rhs: Array) -> tuple[Array, bool]:
    """The solution of M z = rhs by an approximate inverse and corrections, and whether its residual is round-off."""
    z = solve(rhs)
    for _ in range(REFINEMENTS):
        gap = bordered.residual(z, rhs)
        if bordered.negligible(gap, z, rhs):
            return z, True
        z = z + solve(gap)
    return z, bordered.negligible(bordered.residual(z, rhs), z, rhs)
