"""Block elimination on H_y, and the refinement that every structure shares."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Protocol

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.linear.silence import without_warnings
from continuation.linear.system import BorderedSystem, SingularError

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


@frozen(eq=False, slots=False)
class BlockElimination:
    """The bordered system, solved with a factorisation of H_y that is far from singular."""

    bordered: BorderedMatrix
    factor: Factored
    w: Array
    """H_y^{-1} H_lam, shape (N,)."""
    schur: float
    """border_lam - border_y' w = det M / det H_y."""
    factor_whole: Callable[[], BorderedSystem]

    @property
    def sign(self) -> int:
        """Sign of det M = det H_y * schur."""
        return self.factor.sign if self.schur > 0 else -self.factor.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, shape (N + 1,); by the factorisation of the whole where elimination is not accurate."""
        z, accurate = refined(self.bordered, self._eliminate, join(r, rho))
        return z if accurate else self._whole.solve(r, rho)

    def approximate(self, r: Array, rho: float) -> Array:
        """The same without measuring the residual: for an iteration that measures its own."""
        return self._eliminate(join(r, rho))

    def _eliminate(self, rhs: Array) -> Array:
        x = self.factor.solve(rhs[:-1])
        lam: float = (rhs[-1] - self.bordered.row[:-1].dot(x)) / self.schur
        return join(x - lam * self.w, lam)

    @cached_property
    def _whole(self) -> BorderedSystem:
        return self.factor_whole()


@without_warnings(all="ignore")
def eliminate(bordered: BorderedMatrix, factor: Factored, factor_whole: Callable[[], BorderedSystem]) -> BorderedSystem:
    """Border a factorisation of H_y; near a fold, where H_y is useless, factor the whole matrix instead.

    One refinement of ``w = H_y^{-1} H_lam`` shows how singular H_y is to this factorisation: at a fold w is round-off.
    The test depends on no norm, and so on no scaling. Within its limits both signs in ``det M = det H_y * schur`` are
    certain; beyond them neither is, though their product is well determined, and only the whole matrix tells it.

    Raises `SingularError` if `factor_whole` was needed and found M singular.

    References
    ----------
    W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000, section 3.
    """
    row = bordered.row
    w = factor.solve(bordered.column)
    correction = factor.solve(bordered.column - bordered.matrix @ w)
    w = w + correction
    schur = float(row[-1] - row[:-1] @ w)
    trusted = np.abs(correction).max() <= TRUSTED * np.abs(w).max()
    trusted &= abs(schur) > TRUSTED * (abs(row[-1]) + np.abs(row[:-1]) @ np.abs(w))
    return BlockElimination(bordered, factor, w, schur, factor_whole) if trusted else factor_whole()
