"""What may be installed besides SuperLU to factor sparse matrices: CHOLMOD, and algebraic multigrid."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

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


@frozen
class Extra:
    """A way to factor sparse matrices.

    Attributes
    ----------
    name, needs : str
        By which it is asked for, and the package that has to be installed.
    least : int
        The order from which on it is chosen by itself.
    signed : bool
        Whether its factors tell the sign of the determinant.
    suits : callable
        Whether it may do for a matrix, by a look at it.
    factor : callable
        The factors; None where it cannot do it after all.
    """

    name: str
    needs: str
    least: int
    signed: bool
    suits: Callable[[Look], bool]
    factor: Callable[[Look], SparseFactor | None]


def by_cholmod(look: Look) -> SparseFactor | None:
    """Supernodal Cholesky factors, by way of cvxopt; None where a pivot is not positive.

    Chen, Davis, Hager and Rajamanickam, "Algorithm 887: CHOLMOD", ACM Trans. Math. Softw. 35 (2008).
    """
    from cvxopt import cholmod, spmatrix
    from cvxopt import matrix as column

    entries = look.matrix.tocoo()
    lower = entries.row >= entries.col
    data, rows, columns = (np.ascontiguousarray(part[lower]) for part in (entries.data, entries.row, entries.col))
    matrix = spmatrix(data, rows.astype(np.int64), columns.astype(np.int64), look.matrix.shape)
    factors = cholmod.symbolic(matrix)
    try:
        cholmod.numeric(matrix, factors)
    except ArithmeticError:
        return None

    def solve(rhs: Array) -> Array:
        x = column(rhs)
        cholmod.solve(factors, x)
        return np.array(x).ravel()

    # How many numbers they are cvxopt does not say.
    return SparseFactor("CHOLMOD", solve, 0, lambda: 1)


@frozen(eq=False, slots=False)
class Multigrid:
    """Conjugate gradients with a hierarchy of coarser matrices, run again until the residual of each row is round-off.

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


def by_multigrid(look: Look) -> SparseFactor:
    """Algebraic multigrid of Ruge and Stueben, by pyamg, which preconditions conjugate gradients.

    Ruge and Stueben, "Algebraic Multigrid", in McCormick (ed.), Multigrid Methods, SIAM 1987; Bell, Olson and
    Schroder, "PyAMG: Algebraic Multigrid Solvers in Python", J. Open Source Softw. 7 (2022).
    """
    import pyamg

    grids = pyamg.ruge_stuben_solver(csr_matrix(look.matrix))
    # The matrices of all levels, and the interpolations between them.
    fill = sum(grid.A.nnz for grid in grids.levels) + sum(grid.P.nnz for grid in grids.levels[:-1])
    # Dominance proves that the determinant is positive.
    return SparseFactor("multigrid", Multigrid(look, grids).solve, int(fill), lambda: int(look.dominant))


EXTRAS = (
    Extra("amg", "pyamg", 400_000, False, lambda look: look.diffusion, by_multigrid),
    Extra("cholmod", "cvxopt", 1000, True, lambda look: look.definite_perhaps, by_cholmod),
)
"""In the order in which they are chosen, of five-point Laplacians: multigrid takes 2.5 s with one solve where CHOLMOD
takes 4.3 (n = 490,000), 5.0 and 8.0 (1e6), as much at 1e5, and its memory grows as n does; CHOLMOD half of SuperLU's
time from n = 2,000 on, a third at 1e5, and more than it below 400."""
