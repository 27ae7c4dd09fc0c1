"""Dense bordered systems, by LU of the whole matrix."""

from __future__ import annotations

from functools import lru_cache
from math import isfinite

import numpy as np
from attrs import frozen
from numpy.typing import NDArray
from scipy.linalg.blas import dasum, dtbmv
from scipy.linalg.lapack import dgeequb, dgetrf, dgetrs

from continuation.arrays import EPS, SIX_DIGITS, Array
from continuation.contraction import HALVING
from continuation.linear.refine import BACKWARD_ERROR
from continuation.linear.system import SingularError

EQUILIBRATED = 0.1
"""Ratio of smallest to largest row (column) above which LAPACK does not scale."""


def lu_sign(exchanges: NDArray[np.int32], pivots: Array) -> int:
    """Sign of the determinant, from row exchanges and negative pivots."""
    # Counting bytes of short arrays is three times as fast as numpy.
    odd = (exchanges != _rows(len(exchanges))).tobytes().count(1) + np.signbit(pivots).tobytes().count(1)
    return -1 if odd % 2 else 1


@lru_cache(maxsize=4)
def _rows(n: int) -> NDArray[np.int32]:
    return np.arange(n, dtype=np.int32)


HIDDEN = EPS / SIX_DIGITS
"""An entry below this share of the largest may decide its row: LU keeps six digits of it, so solutions are
corrected."""


@frozen(eq=False)
class Dense:
    """LU factors of the bordered matrix, scaled so that pivots do not depend on units."""

    lu: Array
    pivots: NDArray[np.int32]
    scale: Array | None
    """Row factors, powers of two, shape (1, N + 1); None for ones."""
    columns: Array | None
    """Column factors."""
    whole: tuple[Array, Array] | None = None
    """The scaled matrix and its magnitudes."""

    @property
    def sign(self) -> int:
        """Sign of the determinant."""
        return lu_sign(self.pivots, self.lu.diagonal())

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, shape (N + 1,); `SingularError` if not finite."""
        z = np.empty(r.size + 1)
        z[:-1] = r
        z[-1] = rho
        # Keywords would take as long as the work for few unknowns; the last 1: overwrite.
        if self.scale is not None:
            # BLAS does not warn of overflow.
            z = dtbmv(0, self.scale, z, 1, 0, 0, 0, 0, 1)
        if self.whole is None:
            dgetrs(self.lu, self.pivots, z, 0, 1)
        else:
            z = self._corrected(*self.whole, z)
        if self.columns is not None:
            z = dtbmv(0, self.columns, z, 1, 0, 0, 0, 0, 1)
        if not isfinite(dasum(z)):
            raise SingularError("The bordered solution is not finite: overflow, or a bad right-hand side.")
        return z

    def _corrected(self, whole: Array, sizes: Array, right: Array) -> Array:
        """Iterative refinement, row by row (Skeel, Math. Comp. 35, 1980)."""
        z: Array = dgetrs(self.lu, self.pivots, right)[0]
        found = z
        left = before = np.inf
        with np.errstate(all="ignore"):
            # Stop if a correction does not halve the residual.
            while left > BACKWARD_ERROR:
                gap, terms = right - whole @ z, sizes @ np.abs(z) + np.abs(right)
                left = float((np.abs(gap) / np.where(terms > 0.0, terms, 1.0)).max())
                if not left <= HALVING * before:
                    break
                found, before = z, left
                z = z + dgetrs(self.lu, self.pivots, gap)[0]
        return found


def factor_dense(matrix: Array, column: Array, row: Array) -> Dense:
    """Factor ``[[matrix, column], [row']]`` by LU in O(N^3).

    Raises `SingularError` if a pivot is zero or an entry not finite.
    """
    n = len(column)
    whole = np.empty((n + 1, n + 1), order="F")
    whole[:n, :n] = matrix
    whole[:n, n] = column
    whole[n] = row
    if not isfinite(dasum(whole.ravel("K"))):
        raise SingularError("The bordered matrix cannot be factored: it has an entry that is not finite.")
    scale, columns, ratio, column_ratio, _, info = dgeequb(whole)
    if info > 0:
        raise SingularError(f"The bordered matrix is singular: its row or column {(info - 1) % (n + 1)} is zero.")
    if ratio < EQUILIBRATED:
        whole *= scale[:, None]
    else:
        scale = None
    if column_ratio < EQUILIBRATED:
        whole *= columns
    else:
        columns = None
    sizes = None if scale is None and columns is None else np.abs(whole)
    hidden = sizes is not None and sizes.min(where=sizes > 0.0, initial=1.0) < HIDDEN
    kept = (whole.copy(), sizes) if sizes is not None and hidden else None
    lu, pivots, info = dgetrf(whole, 1)
    if info > 0:
        raise SingularError(f"The bordered matrix of order {n + 1} is singular: pivot {info - 1} is zero.")
    return Dense(lu, pivots, None if scale is None else scale[None], None if columns is None else columns[None], kept)


@frozen(eq=False)
class LU:
    """LU factors of a dense matrix."""

    lu: Array
    pivots: NDArray[np.int32]

    @property
    def sign(self) -> int:
        """Sign of the determinant."""
        return lu_sign(self.pivots, self.lu.diagonal())

    def solve(self, rhs: Array) -> Array:
        """The solution, shape (N,)."""
        return np.asarray(dgetrs(self.lu, self.pivots, rhs)[0])


def factor_lu(matrix: Array) -> LU | None:
    """LU factors of a square matrix; None if a pivot is zero."""
    lu, pivots, info = dgetrf(matrix)
    return LU(lu, pivots) if info == 0 else None
