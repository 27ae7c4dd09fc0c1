"""Banded H_y: LU in O(N)."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen
from scipy.linalg.blas import dgbmv
from scipy.linalg.lapack import dgbtrf, dgbtrs
from scipy.sparse import dia_array

from continuation.arguments.checks import integer
from continuation.arrays import Array, Matrix
from continuation.linear.dense import lu_sign
from continuation.linear.entries import real
from continuation.linear.system import Solver


def _diagonals(ab: Any) -> Array:
    return real("ab of Banded", ab)


@frozen(eq=False)
class Banded:
    """A banded matrix in LAPACK's form: ``ab[upper + i - j, j] = A[i, j]``.

    Parameters
    ----------
    ab : Array
        Shape (lower + upper + 1, N). Entries outside A are not read.
    lower, upper : int
        Diagonals below and above the main one.
    """

    ab: Array = field(converter=_diagonals)
    lower: int = field(validator=integer(0))
    upper: int = field(validator=integer(0))

    def __attrs_post_init__(self) -> None:
        rows = self.lower + self.upper + 1
        if self.ab.ndim != 2 or len(self.ab) != rows:
            raise ValueError(f"ab of Banded has shape {self.ab.shape}; expected (lower + upper + 1, N) = ({rows}, N)")

    @property
    def shape(self) -> tuple[int, int]:
        """(N, N)."""
        return (self.ab.shape[1], self.ab.shape[1])

    def tosparse(self) -> Matrix:
        """A scipy sparse array."""
        offsets = np.arange(self.upper, -self.lower - 1, -1)
        inside = np.abs(offsets) < self.ab.shape[1]  # scipy 1.15 moves diagonals outside onto the main one
        return dia_array((self.ab[inside], offsets[inside]), shape=self.shape).tocsc()

    def toarray(self) -> Array:
        """A dense copy."""
        return np.asarray(self.tosparse().toarray())

    def __abs__(self) -> Banded:
        return Banded(np.abs(self.ab), self.lower, self.upper)

    def __matmul__(self, other: Array) -> Array:
        n = self.ab.shape[1]
        if len(other) != n:
            raise ValueError(f"the operand of Banded @ has shape {other.shape}; expected ({n},) or ({n}, k)")
        if other.ndim == 1 and len(self.ab) <= n:
            return np.asarray(dgbmv(n, n, self.lower, self.upper, 1.0, self.ab, other))
        return np.asarray(self.tosparse() @ other)


def factor_band(matrix: Banded) -> Solver | None:
    """LU factors with partial pivoting; None if a pivot is zero."""
    lower, upper = matrix.lower, matrix.upper
    # Row exchanges fill `lower` more diagonals.
    room = np.zeros((2 * lower + upper + 1, matrix.shape[0]), order="F")
    room[lower:] = matrix.ab
    lu, pivots, info = dgbtrf(room, lower, upper, overwrite_ab=1)
    if info > 0:
        return None
    return Solver(
        lambda rhs: dgbtrs(lu, lower, upper, rhs, pivots)[0].ravel(), lambda: lu_sign(pivots, lu[lower + upper])
    )
