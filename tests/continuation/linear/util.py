"""What tests of structures have in common."""

import numpy as np

from continuation.linear import Banded


def tridiagonal(matrix):
    """Its three diagonals."""
    ab = np.zeros((3, matrix.shape[0]))
    ab[0, 1:], ab[1], ab[2, :-1] = matrix.diagonal(1), matrix.diagonal(), matrix.diagonal(-1)
    return Banded(ab, 1, 1)
