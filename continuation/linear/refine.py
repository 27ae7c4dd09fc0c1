"""The refinement that every structure shares: residuals measured row by row."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.linear.silence import without_warnings
from continuation.linear.system import SingularError

REFINEMENTS = 2
"""Corrections that a solve may take before its answer is called inaccurate: each gains the digits of TRUSTED. Here no
ratio of increments is watched, as in `continuation.contraction`, since the residual itself is at hand and decides."""

BACKWARD_ERROR = 16 * float(np.finfo(float).eps)
"""Row-wise backward error below which a solution cannot be improved."""

TRUSTED = 1e-6
"""Largest relative error of H_y^{-1} H_lam, and smallest relative Schur complement, that block elimination may have.

Refinement then gains six digits a step, and the signs of det H_y and of the Schur complement are certain.
"""


class Factored(Protocol):
    """A factorisation of a square matrix A."""

    @property
    def sign(self) -> int:
        """Sign of det A, +1 or -1."""
        ...

    def solve(self, rhs: Array) -> Array:
        """The solution of A x = rhs, shape (N,); `rhs` is not modified."""
        ...


@frozen(eq=False)
class BorderedMatrix:
    """The matrix ``M = [[A, column], [row']]`` itself, to measure residuals with."""

    matrix: Matrix
    """A: anything with ``@``, (N, N)."""
    column: Array
    """(N,)."""
    row: Array
    """(N + 1,)."""
    row_sums: Array
    """Sums of magnitudes of the rows of A, or a bound of that size; shape (N,)."""

    def __attrs_post_init__(self) -> None:
        for name, entries in (("H_y", self.row_sums), ("H_lam", self.column), ("border", self.row)):
            if not np.isfinite(entries).all():
                raise SingularError(f"The bordered matrix cannot be factored: {name} has an entry that is not finite.")

    @classmethod
    def of(cls, matrix: Matrix, column: Array, row: Array) -> BorderedMatrix:
        """Of a matrix whose magnitudes can be had."""
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
        """Whether the residual `gap` of `z` is round-off in each row.

        The measure is invariant under scaling of rows, and under a change of the unit of lambda (Oettli & Prager 1964,
        with |y| replaced by its largest entry).
        """
        largest = np.abs(z[:-1]).max()
        size = np.abs(rhs)
        size[:-1] += self.row_sums * largest + np.abs(self.column * z[-1])
        size[-1] += np.abs(self.row[:-1]).sum() * largest + abs(self.row[-1] * z[-1])
        return bool((np.abs(gap) <= BACKWARD_ERROR * size).all())


def join(r: Array, rho: float) -> Array:
    """The right-hand side (r, rho) in one new array, shape (N + 1,)."""
    rhs = np.empty(len(r) + 1)
    rhs[:-1] = r
    rhs[-1] = rho
    return rhs


@without_warnings(all="ignore")
def refined(bordered: BorderedMatrix, solve: Callable[[Array], Array], rhs: Array) -> tuple[Array, bool]:
    """M z = rhs by `solve`, an approximate inverse, corrected at most `REFINEMENTS` times.

    Returns z, and whether its residual is round-off.
    """
    z = solve(rhs)
    for _ in range(REFINEMENTS):
        gap = bordered.residual(z, rhs)
        if bordered.negligible(gap, z, rhs):
            return z, True
        z = z + solve(gap)
    return z, bordered.negligible(bordered.residual(z, rhs), z, rhs)
