"""Symmetric H_y: Cholesky or LDL'."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dpotrs, dsytrf, dsytrf_lwork, dsytrs

from continuation.arrays import Array, least
from continuation.linear.entries import real
from continuation.linear.refine import Factored


def _dense(matrix: Any) -> Array:
    return real("matrix of Symmetric", matrix)


@frozen(eq=False)
class Symmetric:
    """A dense symmetric matrix, at half the cost of a general one.

    Parameters
    ----------
    matrix : Array
        Shape (N, N); an unsymmetric one is solved correctly, but slowly.
    """

    matrix: Array = field(converter=_dense)

    def __attrs_post_init__(self) -> None:
        if self.matrix.ndim != 2 or self.matrix.shape[0] != self.matrix.shape[1]:
            raise ValueError(f"matrix of Symmetric has shape {self.matrix.shape}; expected (N, N)")

    @property
    def shape(self) -> tuple[int, int]:
        """(N, N)."""
        return (len(self.matrix), len(self.matrix))

    def toarray(self) -> Array:
        """A dense copy, shape (N, N)."""
        return self.matrix.copy()

    def __abs__(self) -> Array:
        return np.abs(self.matrix)

    def __matmul__(self, other: Array) -> Array:
        return np.asarray(self.matrix @ other)


@frozen(eq=False)
class Cholesky:
    """``factor * A = L L'``: a factor 1 or 2 keeps all digits if A is scaled by a power of two."""

    lower: Array
    factor: float

    @property
    def least_pivot(self) -> float:
        """The least pivot of A."""
        return least(self.lower.diagonal()) ** 2 / self.factor

    @property
    def sign(self) -> int:
        """+1."""
        return 1

    def solve(self, rhs: Array) -> Array:
        """The solution, shape (N,)."""
        return np.asarray(self.factor * dpotrs(self.lower, rhs, lower=1)[0].ravel())


@frozen(eq=False)
class LDL:
    """P' A P = L D L' with Bunch-Kaufman pivoting."""

    ldu: Array
    pivots: NDArray[np.int32]
    """LAPACK's: from one, negative in 2x2 blocks."""

    def count(self, side: int) -> int:
        """Number of eigenvalues with a sign: each 2x2 block has one of either."""
        single = self.ldu.diagonal()[self.pivots > 0]
        return (len(self.pivots) - single.size) // 2 + int(np.count_nonzero(side * single > 0.0))

    @property
    def sign(self) -> int:
        """Sign of det A."""
        return -1 if self.count(-1) % 2 else 1

    def solve(self, rhs: Array) -> Array:
        """The solution, shape (N,)."""
        return np.asarray(dsytrs(self.ldu, self.pivots, rhs, lower=1)[0].ravel())


def factor_symmetric(symmetric: Symmetric) -> Factored | None:
    """Factor a symmetric matrix; None if a pivot is zero."""
    matrix = symmetric.matrix
    if (matrix.diagonal() > 0).all() and (factor := factor_cholesky(matrix.T)) is not None:
        return factor
    factors, whole = factor_ldl(matrix)
    return factors if whole else None


def factor_ldl(matrix: Array) -> tuple[LDL, bool]:
    """L D L' of a symmetric matrix, and whether no pivot is zero."""
    work, _ = dsytrf_lwork(len(matrix), lower=1)
    ldu, pivots, info = dsytrf(matrix.T, lower=1, lwork=int(work))
    return LDL(ldu, pivots), info == 0


def factor_cholesky(matrix: Array) -> Cholesky | None:
    """The Cholesky factor, from the lower triangle; None if a pivot is not positive."""
    factor = 2.0 - math.frexp(matrix[0, 0])[1] % 2
    lower, info = dpotrf(factor * matrix, lower=1, clean=0)
    return Cholesky(lower, factor) if info == 0 else None
