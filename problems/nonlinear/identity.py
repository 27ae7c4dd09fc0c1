"""(1 - lam) M + lam I, in the structure of M."""

from __future__ import annotations

import numpy as np
from scipy.sparse import eye_array, issparse
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from continuation.arrays import Matrix
from continuation.linear import Banded


def blend_with_identity(matrix: Matrix, lam: float) -> Matrix:
    """(1 - lam) M + lam I as a new matrix of M's type."""
    if isinstance(matrix, np.ndarray):
        return (1.0 - lam) * matrix + lam * np.eye(len(matrix))
    if isinstance(matrix, Banded):
        bands = (1.0 - lam) * matrix.ab
        bands[matrix.upper] += lam
        return Banded(bands, matrix.lower, matrix.upper)
    if issparse(matrix):
        return (1.0 - lam) * matrix + lam * eye_array(matrix.shape[0], format=matrix.format)
    if isinstance(matrix, LinearOperator):
        return (1.0 - lam) * matrix + lam * aslinearoperator(eye_array(matrix.shape[0]))
    raise TypeError(
        f"F'(x) is of type {type(matrix).__name__}; expected ndarray, scipy sparse array, Banded or LinearOperator"
    )
