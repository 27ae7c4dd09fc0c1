"""Sparse matrices: factored by themselves, or with a border as a whole."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array

from continuation.arrays import Array, Matrix
from continuation.linear.entries import extended
from continuation.linear.factoring import Factoring
from continuation.linear.refine import BorderedMatrix, join, refined
from continuation.linear.superlu import SparseFactor
from continuation.linear.system import BorderedSystem, SingularError, Solver


def canonical(matrix: Matrix) -> Matrix:
    """The matrix by columns, each entry once."""
    matrix = csc_array(matrix, dtype=float)
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    return matrix


def factor_whole(matrix: Matrix, column: Array, row: Array) -> BorderedSystem:
    """Factor the bordered matrix as one sparse matrix with scaled rows.

    The dense row of the border doubles the fill and the time of a factorisation (five-point Laplacian, m = 100), and
    its size, which is a matter of units, can make that ten times: elimination, which depends on H_y alone, comes first.

    Raises
    ------
    SingularError
        If a pivot is exactly zero, or an entry is not finite.
    """
    bordered = BorderedMatrix.of(matrix, column, row)
    n = len(column)
    # The last row at a hundredth of the others: then it is not eliminated early, where it would fill the factors.
    sizes = np.append(bordered.row_sums + np.abs(column), 100 * np.abs(row).max())
    if not sizes.all():
        raise SingularError(f"The bordered matrix is singular: its row {int(np.argmin(sizes))} is zero.")
    scale = np.ldexp(1.0, -np.frexp(sizes)[1])
    top = csc_array(matrix).multiply(scale[:n, None])
    factor = factor_square(extended(top, (scale[:n] * column)[:, None], scale[n] * row[None]))
    if factor is None:
        raise SingularError(f"The bordered matrix of order {n + 1} is singular: a pivot is zero.")

    def solve(r: Array, rho: float) -> Array:
        z, _ = refined(bordered, lambda rhs: factor.solve(scale * rhs), join(r, rho))
        if not np.isfinite(z).all():
            raise SingularError("The bordered solution is not finite: overflow, or a bad right-hand side.")
        return z

    return Solver(solve, factor.tell_sign)


def factor_square(matrix: Matrix) -> SparseFactor | None:
    """Factor a sparse matrix by itself, by what suits it and is installed; None where a pivot is exactly zero.

    Parameters
    ----------
    matrix : csc_array of shape (N, N)
    """
    return Factoring().factor(matrix)
