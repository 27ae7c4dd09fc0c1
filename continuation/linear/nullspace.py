"""A bordered system [[A, P], [R, S]] for a matrix A of any rank, and A's null spaces.

If A has lost at most as many ranks as P has columns, the bordered matrix is regular for almost all borders. Solutions
for unit vectors in the border rows span A's null spaces (Govaerts, Numerical Methods for Bifurcations, Sections 3.3 and
4.1).
"""

from __future__ import annotations

import warnings
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from scipy.linalg import LinAlgWarning, lu_factor, lu_solve
from scipy.sparse.linalg import splu

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, Matrix, generic_vector, largest
from continuation.linear.dense import lu_sign
from continuation.linear.entries import extended
from continuation.linear.superlu import superlu_sign
from continuation.linear.system import SingularError

LONG = 10.0
"""Length of null vectors, over the border's, above which they replace it: the angle is then 84 degrees, a digit is
lost."""

REFRESHED = 4
"""Most replacements of the border; more do not help if two ranks are lost."""

BORDERS = 5
"""Lost ranks that are counted: for a message, two more than `continuation.events.multiple` resolves."""

RANK = SIX_DIGITS
"""Singular values below this, relative to A, are zero."""


@frozen(eq=False, slots=False)
class Bordered:
    """[[A, P], [R, S]], factored; A, (n, m), is dense or sparse, real or complex.

    `shape`: of A. `matrix`: with scaled border rows if sparse. `columns`: P, (n, l). `scale`, (n + k, 1): row factors.
    """

    shape: tuple[int, int]
    matrix: Matrix
    columns: Array
    lu: Any
    scale: Array

    @classmethod
    def of(cls, matrix: Matrix, columns: Array, rows: Array) -> Bordered:
        """Factor A with columns, (n, l), and rows, (k, m + l), or (k, m) for S = 0; SingularError if singular."""
        (n, m), sparse = matrix.shape, sp.issparse(matrix)
        rows = np.hstack([rows, np.zeros((len(rows), m + columns.shape[1] - rows.shape[1]))])
        scale = np.ones((n + len(rows), 1))
        if sparse:
            # Weak rows are eliminated late and do not fill the factors (two species, 2000 unknowns: 17 thousand entries
            # instead of 673); one correction restores the lost digits.
            size = max(float(np.abs(part).max(initial=0.0)) for part in (matrix.data, columns))
            scale[n:, 0] = ROOT_OF_ROUND_OFF * size / np.abs(rows).max(axis=1)
        whole = extended(matrix, columns, rows * scale[n:])
        with warnings.catch_warnings():
            warnings.simplefilter("error", LinAlgWarning)
            try:
                lu = splu(whole) if sparse else lu_factor(whole, check_finite=False)
            except (LinAlgWarning, RuntimeError, ValueError) as error:
                raise SingularError(str(error)) from error
        return cls((n, m), whole, columns, lu, scale)

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

    @property
    def weak(self) -> bool:
        """Whether solutions are so large that more ranks may be lost."""
        return largest(self.solve(generic_vector(len(self.scale)))) * ROOT_OF_ROUND_OFF >= 1.0

    @cached_property
    def right(self) -> tuple[Array, Array]:
        """A basis of the right null space, (m, k), and defects, (l, k), which vanish for true null vectors."""
        (n, m), size = self.shape, len(self.scale)
        found = self.solve(np.eye(size, size - n, -n))
        return found[:m], found[m:]

    @cached_property
    def left(self) -> tuple[Array, Array]:
        """A basis of the left null space, (n, l), and defects, (k, l)."""
        (n, m), size = self.shape, self.matrix.shape[1]
        found = self.solve(np.eye(size, size - m, -m), adjoint=True)
        return found[:n], found[n:]

    def refreshed(self, matrix: Matrix) -> Bordered:
        """Another matrix with these null vectors as borders, which gives the best condition."""
        return Bordered.of(matrix, np.linalg.qr(self.left[0])[0], np.linalg.qr(self.right[0])[0].conj().T)


@frozen(eq=False)
class NearlySingular:
    """Solutions of [[A, b], [c*, 0]] (v, s) = (0, 1) and of the adjoint system, (w, s*) = (0, 1).

    s vanishes where A is singular, with null vectors v and w; s' = -w* A' v.
    """

    factors: Bordered
    border: Array
    right: Array
    left: Array
    s: complex


def null_vectors(matrix: Matrix, b: Array, c: Array) -> NearlySingular:
    """Border a matrix, (n, n), by unit vectors b and c; by its null vectors if b or c is nearly orthogonal to them.

    Raises `SingularError` if several ranks are lost.
    """
    for _ in range(REFRESHED):
        factors = Bordered.of(matrix, b[:, None], c.conj()[None])
        right, left = factors.right[0][:, 0], factors.left[0][:, 0]
        found = NearlySingular(factors, b, right, left, factors.right[1][0, 0])
        v, w = (float(np.linalg.norm(x)) for x in (right, left))
        if v <= LONG and w <= LONG:
            break
        b, c = left / w, right / v
    return found


def kernels(matrix: Matrix) -> tuple[Array, Array]:
    """Orthonormal bases of both kernels of a matrix, shape (N, N + 1), as columns."""
    n = matrix.shape[0]
    k = min(BORDERS, n)
    generator = np.random.default_rng(7)
    bordered = Bordered.of(matrix, generator.standard_normal((n, k)), generator.standard_normal((k + 1, n + 1)))
    return _vanishing(*bordered.right), _vanishing(*bordered.left)


def _vanishing(vectors: Array, defects: Array) -> Array:
    values, turned = np.linalg.svd(defects)[1:]
    rank = int(np.count_nonzero(values > RANK * np.linalg.norm(vectors, 2)))
    basis: Array = np.linalg.qr(vectors @ turned[rank:].T)[0]
    return basis
