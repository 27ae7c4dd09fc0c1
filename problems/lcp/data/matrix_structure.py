"""An LCP's matrix A, its properties and derived matrices."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from scipy.linalg.lapack import dpotrf

from continuation.arrays import Array, Matrix
from continuation.linear import Banded
from problems.lcp.data.problem import LCP, MixedLCP, require_problem

WIDEST_BAND = 16
"""Most diagonals of a banded matrix, gaps included."""

FILL = 8.0
"""Most terms of a sparse A'DA per entry of A and I; beyond, a system of order 2n replaces A'DA."""

SEMIDEFINITE_SHIFT = 100 * float(np.finfo(float).eps)
"""Diagonal shift, per unknown, that lets semidefinite matrices pass Cholesky (Higham, Theorem 10.3)."""


LARGEST_SYMMETRIC_PART = 1000
"""Most nonempty rows of a sparse A + A' for a dense factorisation."""


def semidefinite(symmetric: Array) -> bool:
    """Whether a symmetric matrix is positive semidefinite to working precision (Cholesky)."""
    diagonal, n = symmetric.diagonal(), len(symmetric)
    if (diagonal < 0.0).any():
        return False
    # Shifts follow the diagonal: factorisations ignore its scaling.
    shifted, rows = symmetric.copy(), np.abs(symmetric).max(axis=1)
    sizes = np.where(diagonal > 0.0, diagonal, np.where(rows > 0.0, rows, 1.0))
    shifted[np.diag_indices(n)] += SEMIDEFINITE_SHIFT * n * sizes
    return bool(dpotrf(shifted.T, lower=1, overwrite_a=1, clean=0)[1] == 0)


def scaled(A: Matrix, columns: Array, diagonal: Array) -> Matrix:
    """``A diag(columns) + diag(diagonal)``, stored as A: dense, sparse or `Banded`."""
    if isinstance(A, Banded):
        return scaled_band(A, 1.0, columns, diagonal)
    if sp.issparse(A):
        return (A @ sp.diags_array(columns) + sp.diags_array(diagonal)).asformat(A.format)
    dense = A * columns
    dense[np.diag_indices(len(A))] += diagonal
    return dense


def scaled_band(band: Banded, rows: float | Array, columns: Array, diagonal: Array) -> Banded:
    """``diag(rows) A diag(columns) + diag(diagonal)`` of a banded A."""
    ab = band.ab * columns * _by_rows(band, rows)
    ab[band.upper] += diagonal
    return Banded(ab, band.lower, band.upper)


def _by_rows(band: Banded, values: float | Array) -> Array:
    """A row's value at the place of each entry: ``values[j + r - upper]`` at (r, j)."""
    n = band.shape[0]
    padded = np.zeros(n + band.lower + band.upper)
    padded[band.upper : band.upper + n] = values
    step = padded.itemsize
    return np.ndarray((len(band.ab), n), float, padded, strides=(step, step))


def normal_band(band: Banded, factor: float, weights: Array, diagonal: Array) -> Banded:
    """``factor (A + A' + A' diag(weights) A) + diag(diagonal)`` of a banded A."""
    ab, n, width = band.ab, band.shape[0], band.lower + band.upper
    weighted = ab * _by_rows(band, weights)
    whole = np.zeros((2 * width + 1, n))
    for k in range(min(width + 1, n)):
        found = (weighted[k:, : n - k] * ab[: width + 1 - k, k:]).sum(axis=0)
        if k <= band.lower:
            found += ab[band.upper + k, : n - k]
        if k <= band.upper:
            found += ab[band.upper - k, k:]
        whole[width + k, : n - k] = whole[width - k, k:] = factor * found
    whole[width] += diagonal
    return Banded(whole, width, width)


@frozen(eq=False, slots=False)
class Structure:
    """The matrix A of a problem, shared by the homotopies of all starts.

    Parameters
    ----------
    problem : MixedLCP
    """

    problem: MixedLCP | LCP = field(validator=lambda instance, attribute, value: require_problem(value))

    def of_same_matrix(self, problem: LCP) -> Structure:
        """The structure of a problem with the same A, with what is known of A.

        Parameters
        ----------
        problem : LCP
        """
        other = object.__new__(Structure)
        vars(other).update(vars(self) | {"problem": problem})
        return other

    @cached_property
    def transpose(self) -> Matrix:
        """A', a view if dense."""
        return self.problem.A.T.tocsr() if self.problem.sparse else self.problem.A.T

    @cached_property
    def symmetrized(self) -> Matrix:
        """A + A'."""
        return sp.csr_array(self.problem.A + self.transpose) if self.problem.sparse else self.problem.A + self.transpose

    @cached_property
    def band(self) -> Banded | None:
        """The matrix's diagonals if it is sparse with few of them, else None."""
        if not self.problem.sparse:
            return None
        entries = self.problem.A.tocoo()
        below = entries.row.astype(np.int64) - entries.col
        lower, upper = int(max(0, below.max(initial=0))), int(max(0, -below.min(initial=0)))
        if lower + upper + 1 > min(WIDEST_BAND, self.problem.n):
            return None
        ab = np.zeros((lower + upper + 1, self.problem.n))
        ab[upper + below, entries.col] = entries.data
        return Banded(ab, lower, upper)

    @cached_property
    def squarable(self) -> bool:
        """Whether A'DA may be formed."""
        if not self.problem.sparse or self.band is not None:
            return True
        terms = float((np.diff(self.problem.A.indptr).astype(float) ** 2).sum())
        return terms <= FILL * float(self.problem.A.nnz + self.problem.n)

    @cached_property
    def symmetric(self) -> bool:
        """Whether A = A' exactly."""
        if self.problem.sparse:
            return float(abs(self.problem.A - self.transpose).max()) == 0.0
        # One row and column show most asymmetries.
        A = self.problem.A
        return not np.count_nonzero(A[0] != A[:, 0]) and not np.count_nonzero(A != A.T)

    @cached_property
    def semidefinite(self) -> bool:
        """Whether A + A' is positive semidefinite to working precision: by Cholesky, or by dominance if sparse."""
        S = self.symmetrized
        if not self.problem.sparse:
            return semidefinite(S)
        S.eliminate_zeros()
        rows = np.flatnonzero(np.diff(S.indptr) > 0)
        if rows.size <= LARGEST_SYMMETRIC_PART and not self.problem.standard:
            return not rows.size or semidefinite(S[rows][:, rows].toarray())
        return bool((2.0 * S.diagonal() >= np.asarray(abs(S).sum(axis=1))).all())

    @cached_property
    def negative_diagonal(self) -> bool:
        """Whether some a_ii < 0: then A is not copositive."""
        return bool(self.problem.A.diagonal().min() < 0.0)

    @cached_property
    def z_matrix(self) -> bool:
        """Whether off-diagonal entries are <= 0: in n steps active sets reach the least feasible point, or fail."""
        A = self.problem.A
        entries = A.data if self.problem.sparse else A
        return bool(np.count_nonzero(entries > 0.0) == np.count_nonzero(A.diagonal() > 0.0))

    def scaled(self, factor: float, columns: Array, diagonal: Array) -> Matrix:
        """``factor A diag(columns) + diag(diagonal)``, shape (n, n), stored as A.

        Parameters
        ----------
        factor : float
        columns, diagonal : ndarray, shape (n,)
        """
        found = scaled(self.problem.A if self.band is None else self.band, factor * columns, diagonal)
        return found.tocsc() if sp.issparse(found) else found

    def normal(self, factor: float, weights: Array, diagonal: Array) -> Matrix:
        """``factor (A + A' + A' diag(weights) A) + diag(diagonal)``, shape (n, n), stored as A.

        Parameters
        ----------
        factor : float
        weights, diagonal : ndarray, shape (n,)
        """
        if self.band is not None:
            return normal_band(self.band, factor, weights, diagonal)
        A = self.problem.A
        if self.problem.sparse:
            square = self.transpose @ (sp.diags_array(weights) @ A)
            return sp.csc_array(factor * (self.symmetrized + square) + sp.diags_array(diagonal))
        if (weights >= 0.0).all():
            # numpy's product with a transpose takes half the work.
            half = np.sqrt(weights)[:, None] * A
            square = half.T @ half
        else:
            square = A.T @ (weights[:, None] * A)
        square += self.symmetrized
        square *= factor
        square[np.diag_indices(len(A))] += diagonal
        return square

    def augmented(
        self, factor: float, shift: float, columns: Array, diagonal: Array, z2: Array, w: Array, turn: Array | None
    ) -> Matrix:
        """``[[factor (A + A') + shift I, -factor A'], [diag(z2) A, diag(w)]]``, the first n columns scaled;
        ``diagonal`` is added to the first block.

        Parameters
        ----------
        factor, shift : float
        columns, diagonal, z2, w : ndarray, shape (n,)
        turn : ndarray, shape (n,), or None
            Column scaling of ``-factor A'``.

        Returns
        -------
        ndarray or sparse array, shape (2n, 2n)
        """
        zero, one = np.zeros(w.size), np.ones(w.size)
        top = scaled(self.symmetrized, factor * columns, shift * columns + diagonal)
        right = scaled(self.transpose, -factor * (one if turn is None else turn), zero)
        bottom = scaled(scaled(self.transpose, z2, zero).T, columns, zero)
        if self.problem.sparse:
            return sp.block_array([[top, right], [bottom, sp.diags_array(w)]], format="csc")
        return np.asfortranarray(np.block([[top, right], [bottom, np.diag(w)]]))
