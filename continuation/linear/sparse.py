"""Sparse H_y: factors of H_y bordered by elimination, or of the whole matrix at a fold."""

from __future__ import annotations

import numpy as np
from attrs import frozen
from scipy.sparse import csc_array

from continuation.arrays import Array, Matrix
from continuation.linear.entries import extended
from continuation.linear.factoring import Factoring
from continuation.linear.refine import BorderedMatrix, eliminate, join, refined
from continuation.linear.superlu import SparseFactor
from continuation.linear.system import BorderedSystem, SingularError


@frozen(eq=False)
class SparseWhole:
    """The bordered matrix factored as one sparse matrix with scaled rows."""

    bordered: BorderedMatrix
    factor: SparseFactor
    scale: Array
    """Factors of the rows, (N + 1,)."""

    @property
    def sign(self) -> int:
        """Sign of the determinant."""
        return self.factor.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, shape (N + 1,).

        Raises
        ------
        SingularError
            If z overflows, or the right-hand side is not finite.
        """
        z, _ = refined(self.bordered, lambda rhs: self.factor.solve(self.scale * rhs), join(r, rho))
        if not np.isfinite(z).all():
            raise SingularError("The bordered solution is not finite: overflow, or a bad right-hand side.")
        return z


def factor_sparse(matrix: Matrix, column: Array, row: Array) -> BorderedSystem:
    """Factor H_y and border it; at a fold factor the whole matrix.

    The dense row of the border doubles the fill and the time of a factorisation of the whole (five-point Laplacian, m =
    100), and its size, which is a matter of units, can make that ten times; elimination depends on H_y alone.

    Raises
    ------
    SingularError
        If the bordered matrix is exactly singular, or an entry is not finite.
    """
    matrix = csc_array(matrix, dtype=float)
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    bordered = _measured(matrix, column, row)
    factor = factor_square(matrix)
    if factor is None:
        return factor_whole(matrix, column, row)
    return eliminate(bordered, factor, lambda: factor_whole(matrix, column, row))


def factor_whole(matrix: Matrix, column: Array, row: Array) -> SparseWhole:
    """Factor the bordered matrix as one sparse matrix.

    Raises
    ------
    SingularError
        If a pivot is exactly zero, or an entry is not finite.
    """
    bordered = _measured(matrix, column, row)
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
    return SparseWhole(bordered, factor, scale)


def _measured(matrix: Matrix, column: Array, row: Array) -> BorderedMatrix:
    with np.errstate(over="ignore"):
        return BorderedMatrix(matrix, column, row, abs(matrix) @ np.ones(len(column)))


def factor_square(matrix: Matrix) -> SparseFactor | None:
    """Factor a sparse matrix by itself, by what suits it and is installed; None where a pivot is exactly zero.

    Parameters
    ----------
    matrix : csc_array of shape (N, N)
    """
    return Factoring(signed=True).factor(matrix)
