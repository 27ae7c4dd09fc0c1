"""The factorisation for each type of H_y."""

from __future__ import annotations

import numpy as np
from scipy.sparse import issparse
from scipy.sparse.linalg import LinearOperator

from continuation.arrays import Array, Matrix
from continuation.linear.banded import Banded, factor_band
from continuation.linear.dense import factor_dense
from continuation.linear.elimination import eliminate
from continuation.linear.entries import real, require_real
from continuation.linear.operator import Operator, factor_operator
from continuation.linear.sparse import canonical, factor_square, factor_whole
from continuation.linear.system import BorderedSystem


def factor_bordered(H_y: Matrix, H_lam: Array, border: Array) -> BorderedSystem:
    """Factor ``M = [[H_y, H_lam], [border']]`` by the method for the type of `H_y`.

    Parameters
    ----------
    H_y : ndarray, Banded, scipy sparse array, LinearOperator or Operator
        Shape (N, N), N >= 1; may be singular if M is not. Dense ones are copied.
    H_lam : Array
        Shape (N,).
    border : Array
        Shape (N + 1,).

    Raises
    ------
    SingularError
        If M is singular or not finite.
    TypeError
        If `H_y` has another type or is not real.
    ValueError
        If the shapes do not fit.
    """
    if isinstance(H_y, LinearOperator):
        H_y = Operator(H_y)
    if not (isinstance(H_y, np.ndarray | Banded | Operator) or issparse(H_y)):
        raise TypeError(
            f"H_y is of type {type(H_y).__name__}; expected ndarray, Banded, a scipy sparse array, "
            "LinearOperator or Operator"
        )
    column, row = real("H_lam", H_lam), real("border", border)
    n = column.size
    if n < 1 or column.shape != (n,) or H_y.shape != (n, n) or row.shape != (n + 1,):
        raise ValueError(
            f"H_y, H_lam, border have shapes {H_y.shape}, {column.shape}, {row.shape}; "
            "expected (N, N), (N,), (N + 1,) with N >= 1"
        )
    if isinstance(H_y, Operator):
        return factor_operator(H_y, column, row)
    if isinstance(H_y, Banded):
        return eliminate(H_y, column, row, factor_band, lambda: factor_whole(H_y.tosparse(), column, row))
    require_real("H_y", H_y.dtype)
    if isinstance(H_y, np.ndarray):
        return factor_dense(H_y, column, row)
    matrix = canonical(H_y)
    return eliminate(matrix, column, row, factor_square, lambda: factor_whole(matrix, column, row))
