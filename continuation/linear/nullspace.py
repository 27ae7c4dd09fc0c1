"""Bordered matrices of any rank, and null vectors."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from scipy.linalg import LinAlgWarning, lu_factor, lu_solve
from scipy.sparse.linalg import splu

from continuation.arrays import Array, Matrix
from continuation.linear.dense import lu_sign
from continuation.linear.entries import extended
from continuation.linear.superlu import superlu_sign
from continuation.linear.system import SingularError

LONG = 10.0
"""Ratio of null vectors to border above which they replace it; the angle is 84 degrees, and a digit is lost."""

REFRESHED = 4
"""Limit of attempts; more do not help if two ranks are lost."""

BORDER_SIZE = 1e-8
"""Largest border entry relative to a sparse matrix's: weak rows are eliminated late and do not fill the factors
(Laplacian of two species, 2000 unknowns: 17 thousand entries, 673 thousand at 1e-4). One correction restores the lost
half of the digits."""


@frozen(eq=False)
class Bordered:
    """[[A, P], [R, S]] with k border rows, factored whole; A is dense or sparse, real or complex, of any rank.

    Attributes
    ----------
    matrix : ndarray or sparse array
        The whole; sparse border rows are scaled.
    lu : object
        Its factors.
    scale : ndarray, shape (n + k, 1)
        Row factors.
    """

    matrix: Matrix
    lu: Any
    scale: Array

    @classmethod
    def of(cls, matrix: Matrix, columns: Array, rows: Array) -> Bordered:
        """Factor A, (n, m), with columns, (n, l), and rows, (k, m + l), or raise `SingularError`."""
        sparse, scale = sp.issparse(matrix), np.ones((matrix.shape[0] + len(rows), 1))
        if sparse:
            largest = max(float(np.abs(part).max(initial=0.0)) for part in (matrix.data, columns))
            scale[matrix.shape[0] :, 0] = BORDER_SIZE * largest / np.abs(rows).max(axis=1)
        whole = extended(matrix, columns, rows * scale[matrix.shape[0] :])
        with warnings.catch_warnings():
            warnings.simplefilter("error", LinAlgWarning)
            try:
                return cls(whole, splu(whole) if sparse else lu_factor(whole, check_finite=False), scale)
            except (LinAlgWarning, RuntimeError, ValueError) as error:
                raise SingularError(str(error)) from error

    def solve(self, rhs: Array, adjoint: bool = False) -> Array:
        """The solution of M x = rhs, or M* x = rhs, for one or more columns."""
        columns = rhs.reshape(len(rhs), -1)
        if sp.issparse(self.matrix):
            x = self._sparse(columns.astype(self.matrix.dtype), adjoint)
        else:
            x = lu_solve(self.lu, columns, trans=2 if adjoint else 0, check_finite=False)
        if not np.isfinite(x).all():
            raise SingularError("the bordered solution is not finite")
        return np.asarray(x.reshape(rhs.shape))

    def _sparse(self, rhs: Array, adjoint: bool) -> Array:
        """One correction makes up for weak pivots."""
        how, matrix = ("H", self.matrix.conj().T) if adjoint else ("N", self.matrix)
        rhs = rhs if adjoint else rhs * self.scale
        x: Array = self.lu.solve(rhs, how)
        x = x + self.lu.solve(rhs - matrix @ x, how)
        return x * self.scale if adjoint else x

    @property
    def sign(self) -> int:
        """Sign of the determinant of a real matrix."""
        if sp.issparse(self.matrix):
            return superlu_sign(self.lu)
        lu, pivots = self.lu
        return lu_sign(pivots, lu.diagonal())


@frozen(eq=False)
class NearlySingular:
    """Solutions of [[A, b], [c*, 0]] (v, s) = (0, 1) and of the adjoint system, (w, s*) = (0, 1).

    s vanishes where A is singular, with null vectors v and w; s' = -w* A' v (Govaerts, Numerical Methods for
    Bifurcations of Dynamical Equilibria, Section 4.1).
    """

    factors: Bordered
    border: Array
    right: Array
    left: Array
    s: complex
    made: int
    """Number of factorisations."""


def null_vectors(matrix: Matrix, b: Array, c: Array) -> NearlySingular:
    """Border a matrix, (n, n), by unit vectors b and c, or, if nearly orthogonal to its null vectors, by these.

    Matrices share no state, so resumed paths are the same. Raises `SingularError` if several ranks are lost.
    """
    unit = np.zeros(len(b) + 1)
    unit[-1] = 1.0
    for made in range(1, REFRESHED + 1):
        factors = Bordered.of(matrix, b[:, None], np.append(c.conj(), 0.0)[None])
        right, left = factors.solve(unit.astype(b.dtype)), factors.solve(unit.astype(b.dtype), adjoint=True)
        found = NearlySingular(factors, b, right[:-1], left[:-1], right[-1], made)
        v, w = (float(np.linalg.norm(x)) for x in (found.right, found.left))
        if v <= LONG and w <= LONG:
            break
        b, c = found.left / w, found.right / v
    return found
