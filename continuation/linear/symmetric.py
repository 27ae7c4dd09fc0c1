"""Cholesky factors of dense matrices."""

from __future__ import annotations

import math

import numpy as np
from attrs import frozen
from scipy.linalg.lapack import dpotrf, dpotrs

from continuation.arrays import Array, least


@frozen(eq=False)
class Cholesky:
    """``factor * A = L L'``; the factor 1 or 2 keeps all digits if A is scaled by a power of two."""

    lower: Array
    factor: float

    @property
    def least_pivot(self) -> float:
        """Least pivot of A."""
        return least(self.lower.diagonal()) ** 2 / self.factor

    @property
    def sign(self) -> int:
        """+1."""
        return 1

    def solve(self, rhs: Array) -> Array:
        """The solution, shape (N,)."""
        return np.asarray(self.factor * dpotrs(self.lower, rhs, lower=1)[0].ravel())


def factor_cholesky(matrix: Array) -> Cholesky | None:
    """The Cholesky factor, from the lower triangle; None if a pivot is not positive."""
    factor = 2.0 - math.frexp(matrix[0, 0])[1] % 2
    lower, info = dpotrf(factor * matrix, lower=1, clean=0)
    return Cholesky(lower, factor) if info == 0 else None
