"""Conjugate gradients with algebraic multigrid, by pyamg, corrected until the residual of each row is round-off."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from attrs import frozen
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import cg

from continuation.arrays import Array
from continuation.contraction import HALVING
from continuation.linear.look import Look
from continuation.linear.refine import BACKWARD_ERROR
from continuation.linear.superlu import SparseFactor, SuperLUMethod

GAINED = 1e-7
"""What one run of conjugate gradients leaves of a residual: two or three bring it to round-off. With one alone its
recurrence would say that more is gained than is."""

ITERATIONS = 60
"""A run takes four to eight on grids of 1e4 to 1e6 points; where these are not enough multigrid is no good."""

GOOD_ENOUGH = 1e-12
"""Normwise backward error of the point that is then given back; beyond it the matrix is factored after all."""


@frozen(eq=False, slots=False)
class Multigrid:
    """A hierarchy of coarser matrices in place of factors.

    `levels`: The hierarchy of pyamg.
    """

    look: Look
    levels: Any

    @cached_property
    def _preconditioner(self) -> Any:
        return self.levels.aspreconditioner(cycle="V")

    @cached_property
    def _direct(self) -> Any:
        return SuperLUMethod().factor(self.look)

    def solve(self, rhs: Array) -> Array:
        """The solution of A x = rhs, shape (N,): its residual is measured."""
        A, sums = self.look.matrix, self.look.row_sums
        x: Array = np.zeros_like(rhs)
        gap, off, before = rhs, 1.0, np.inf
        # A run that does not halve what is left is the last.
        while off <= HALVING * before:
            step, left = cg(A, gap, rtol=GAINED, maxiter=ITERATIONS, M=self._preconditioner)
            if left or not np.isfinite(step).all():
                break
            x, before = x + step, off
            gap = rhs - A @ x
            size = sums * np.abs(x).max() + np.abs(rhs)
            off = float((np.abs(gap) / np.where(size > 0.0, size, 1.0)).max())
            if off <= BACKWARD_ERROR or (off <= GOOD_ENOUGH and off > HALVING * before):
                return x
        direct = self._direct
        return np.full_like(rhs, np.nan) if direct is None else np.asarray(direct.solve(rhs))


@frozen
class MultigridMethod:
    """Algebraic multigrid of Ruge and Stueben, which preconditions conjugate gradients.

    References
    ----------
    Ruge and Stueben, "Algebraic Multigrid", in McCormick (ed.), Multigrid Methods, SIAM 1987; Bell, Olson and
    Schroder, "PyAMG: Algebraic Multigrid Solvers in Python", J. Open Source Softw. 7 (2022).
    """

    name: ClassVar[str] = "amg"
    needs: ClassVar[str] = "pyamg"
    signed: ClassVar[bool] = False
    least: ClassVar[float] = 400_000.0
    """With one solve 2.5 s where CHOLMOD takes 4.3 (n = 490,000), 5.0 and 8.0 (1e6), as much at 1e5 (five-point
    Laplacian); and its memory grows as n does."""

    def suits(self, look: Look) -> bool:
        """Whether the matrix is of the diffusion kind."""
        return look.diffusion

    def factor(self, look: Look) -> SparseFactor:
        """The hierarchy."""
        import pyamg

        grids = pyamg.ruge_stuben_solver(csr_matrix(look.matrix))
        # The matrices of all levels, and the interpolations between them.
        fill = sum(grid.A.nnz for grid in grids.levels) + sum(grid.P.nnz for grid in grids.levels[:-1])
        # Dominance proves that the determinant is positive.
        return SparseFactor("multigrid", Multigrid(look, grids).solve, int(fill), lambda: int(look.dominant))
