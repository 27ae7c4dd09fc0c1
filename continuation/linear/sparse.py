"""Sparse matrices, factored with or without a border."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array

from continuation.arrays import Array, Matrix
from continuation.linear.entries import extended
from continuation.linear.factoring import Factoring
from continuation.linear.refine import BorderedMatrix, join, refined
from continuation.linear.system import BorderedSystem, SingularError, Solver


def canonical(matrix: Matrix) -> Matrix:
    """Matrix as csc, without duplicates."""
    matrix = csc_array(matrix, dtype=float)
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    return matrix


def factor_whole(matrix: Matrix, column: Array, row: Array) -> BorderedSystem:
    """Factor the bordered matrix, with twice the fill and time; `SingularError` if singular or not finite."""
    bordered = BorderedMatrix.of(matrix, column, row)
    n = len(column)
    # A small last row is eliminated late, without fill.
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


def factor_square(matrix: Matrix) -> Solver | None:
    """Factor a csc matrix by a suitable method; None if a pivot is zero."""
    return Factoring().factor(matrix)
