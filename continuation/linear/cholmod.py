"""CHOLMOD by way of cvxopt: supernodal Cholesky factors of a symmetric positive definite matrix."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear.look import Look
from continuation.linear.superlu import SparseFactor


@frozen
class CholmodMethod:
    """Factorisations by CHOLMOD.

    References
    ----------
    Chen, Davis, Hager and Rajamanickam, "Algorithm 887: CHOLMOD, Supernodal Sparse Cholesky Factorization and
    Update/Downdate", ACM Trans. Math. Softw. 35 (2008).
    """

    name: ClassVar[str] = "cholmod"
    needs: ClassVar[str] = "cvxopt"
    signed: ClassVar[bool] = True
    least: ClassVar[float] = 1000.0
    """Half of SuperLU's time from n = 2,000 on, a third at 1e5 (five-point Laplacian); below 400 SuperLU is quicker."""

    def suits(self, look: Look) -> bool:
        """Whether the matrix may be symmetric and positive definite."""
        return look.definite_perhaps

    def factor(self, look: Look) -> SparseFactor | None:
        """The factors; None where a pivot is not positive."""
        from cvxopt import cholmod, spmatrix
        from cvxopt import matrix as column

        entries = look.matrix.tocoo()
        lower = entries.row >= entries.col
        parts = (np.ascontiguousarray(part[lower]) for part in (entries.data, entries.row, entries.col))
        data, rows, columns = parts
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
