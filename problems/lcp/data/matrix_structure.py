"""An LCP's matrix (dense, sparse or banded), its properties and derived matrices."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from scipy.linalg.lapack import dpotrf

from continuation.arrays import Array, Matrix
from continuation.linear import Banded
from problems.lcp.data.problem import LCP, MixedLCP, require_problem
from problems.lcp.data.ranges import Ranges, ranges

WIDEST_BAND = 16
"""Most diagonals, gaps included, of a banded matrix."""

FILL = 8.0
"""Most terms of a sparse A'DA per entry of A and I.

Beyond, a system of order 2n, as sparse as A, replaces it.
"""

SEMIDEFINITE_SHIFT = 100 * float(np.finfo(float).eps)
"""Diagonal shift per unknown with which semidefinite matrices pass Cholesky.

Its rounding is about n eps of the diagonal (Higham, Theorem 10.3), that of data like M M' as much again.
"""


LARGEST_SYMMETRIC_PART = 1000
"""Most nonempty rows of a sparse A with bounds for a dense factorisation of A + A'."""


def semidefinite(symmetric: Array) -> bool:
    """Whether a symmetric matrix is positive semidefinite to working precision (Cholesky)."""
    diagonal, n = symmetric.diagonal(), len(symmetric)
    if (diagonal < 0.0).any():
        return False
    # Shifts follow the diagonal, as factorisations ignore its scaling.
    shifted, sizes = symmetric.copy(), diagonal
    if (diagonal == 0.0).any():
        # A zero diagonal entry takes its row's largest entry.
        rows = np.abs(symmetric).max(axis=1)
        sizes = np.where(diagonal > 0.0, diagonal, np.where(rows > 0.0, rows, 1.0))
    shifted[np.diag_indices(n)] += SEMIDEFINITE_SHIFT * n * sizes
    # The transpose is in LAPACK's order.
    return bool(dpotrf(shifted.T, lower=1, overwrite_a=1, clean=0)[1] == 0)


@frozen(eq=False)
class Band:
    """The diagonals of a banded matrix: ``rows[lower + k, i] = A[i, i + k]`` for -lower <= k <= upper, else 0."""

    rows: Array
    lower: int
    upper: int

    def scaled(self, factor: float | Array, columns: Array, diagonal: Array) -> Banded:
        """``factor A diag(columns) + diag(diagonal)``; one factor, or one a row."""
        n = self.rows.shape[1]
        rows = factor * self.rows
        ab = np.zeros((self.lower + self.upper + 1, n))
        for k in range(-self.lower, self.upper + 1):
            begin, end = max(0, -k), min(n, n - k)
            ab[self.upper - k, begin + k : end + k] = rows[self.lower + k, begin:end] * columns[begin + k : end + k]
        ab[self.upper] += diagonal
        return Banded(ab, self.lower, self.upper)

    def normal(self, factor: float, weights: Array, diagonal: Array) -> Banded:
        """``factor (A + A' + A' diag(weights) A) + diag(diagonal)``, half bandwidth lower + upper."""
        n, width = self.rows.shape[1], self.lower + self.upper
        ab = np.zeros((2 * width + 1, n))
        offsets = range(-self.lower, self.upper + 1)
        for k in offsets:
            weighted = weights * self.rows[self.lower + k]
            for m in offsets:
                begin, end = max(0, -k, -m), min(n, n - k, n - m)
                if begin < end:
                    ab[width + k - m, begin + m : end + m] += (weighted * self.rows[self.lower + m])[begin:end]
            begin, end = max(0, -k), min(n, n - k)
            entries = self.rows[self.lower + k, begin:end]
            ab[width - k, begin + k : end + k] += entries
            ab[width + k, begin:end] += entries
        ab *= factor
        ab[width] += diagonal
        return Banded(ab, width, width)


@frozen(eq=False, slots=False)
class Structure:
    """The matrix A of a problem, shared by the homotopies of all starts.

    Parameters
    ----------
    problem : MixedLCP
    """

    problem: MixedLCP | LCP = field(validator=lambda instance, attribute, value: require_problem(value))

    @property
    def n(self) -> int:
        """The order of A."""
        return self.problem.n

    @cached_property
    def transpose(self) -> Matrix:
        """A', a view if dense."""
        return self.problem.A.T.tocsr() if self.problem.sparse else self.problem.A.T

    @cached_property
    def symmetrized(self) -> Matrix:
        """A + A'."""
        return sp.csr_array(self.problem.A + self.transpose) if self.problem.sparse else self.problem.A + self.transpose

    @cached_property
    def band(self) -> Band | None:
        """The diagonals of a sparse matrix with few near the main one, else None."""
        if not self.problem.sparse:
            return None
        entries = self.problem.A.tocoo()
        offsets = entries.col.astype(np.int64) - entries.row
        lower, upper = int(max(0, -offsets.min(initial=0))), int(max(0, offsets.max(initial=0)))
        if lower + upper + 1 > min(WIDEST_BAND, self.n):
            return None
        rows = np.zeros((lower + upper + 1, self.n))
        rows[lower + offsets, entries.row] = entries.data
        return Band(rows, lower, upper)

    @cached_property
    def ranges(self) -> Ranges | None:
        """The two-sided rows, if any."""
        return ranges(self.problem)

    @cached_property
    def squarable(self) -> bool:
        """Whether A'DA may be formed (A dense or banded, or little fill)."""
        if not self.problem.sparse or self.band is not None:
            return True
        terms = float((np.diff(self.problem.A.indptr).astype(float) ** 2).sum())
        return terms <= FILL * float(self.problem.A.nnz + self.n)

    @cached_property
    def symmetric(self) -> bool:
        """Whether A = A' exactly."""
        if "symmetric" in self.problem.known:
            return True
        if self.problem.sparse:
            return float(abs(self.problem.A - self.transpose).max()) == 0.0
        # One row and column show most asymmetries cheaply.
        A = self.problem.A
        return not np.count_nonzero(A[0] != A[:, 0]) and not np.count_nonzero(A != A.T)

    @cached_property
    def semidefinite(self) -> bool:
        """Whether A + A' is proved positive semidefinite, to working precision.

        Dense: by Cholesky. Sparse: by diagonal dominance (Gershgorin). Wrong answers cost only time.
        """
        diagonal = self.symmetrized.diagonal()
        if (diagonal < 0.0).any():
            return False
        if self.problem.sparse:
            few = int((np.diff(self.symmetrized.indptr) > 0).sum()) <= LARGEST_SYMMETRIC_PART
            if few and not self.problem.standard:
                return self.definite_where_it_has_entries()
            return bool((2.0 * diagonal >= np.asarray(abs(self.symmetrized).sum(axis=1))).all())
        return semidefinite(self.symmetrized)

    def definite_where_it_has_entries(self) -> bool:
        """Whether a sparse A + A' is semidefinite, by its nonempty rows (a program's P)."""
        S = self.symmetrized
        S.eliminate_zeros()
        rows = np.flatnonzero(np.diff(S.indptr) > 0)
        return not rows.size or semidefinite(S[rows][:, rows].toarray())

    def scaled(self, factor: float, columns: Array, diagonal: Array) -> Matrix:
        """``factor A diag(columns) + diag(diagonal)``, shape (n, n), stored as A.

        Parameters
        ----------
        factor : float
        columns, diagonal : ndarray, shape (n,)

        Returns
        -------
        ndarray, sparse array or Banded
        """
        if self.band is not None:
            return self.band.scaled(factor, columns, diagonal)
        if self.problem.sparse:
            return sp.csc_array(self.problem.A @ sp.diags_array(factor * columns) + sp.diags_array(diagonal))
        dense = self.problem.A * (factor * columns)
        dense[np.diag_indices(self.n)] += diagonal
        return dense

    def normal(self, factor: float, weights: Array, diagonal: Array) -> Matrix:
        """``factor (A + A' + A' diag(weights) A) + diag(diagonal)``, shape (n, n), stored as A.

        Parameters
        ----------
        factor : float
        weights, diagonal : ndarray, shape (n,)

        Returns
        -------
        ndarray, sparse array or Banded
        """
        if self.band is not None:
            return self.band.normal(factor, weights, diagonal)
        A = self.problem.A
        if self.problem.sparse:
            square = self.transpose @ (sp.diags_array(weights) @ A)
            return sp.csc_array(factor * (self.symmetrized + square) + sp.diags_array(diagonal))
        if (weights >= 0.0).all():
            # numpy gives a matrix times its transpose to dsyrk: half the work.
            half = np.sqrt(weights)[:, None] * A
            square = half.T @ half
        else:
            square = A.T @ (weights[:, None] * A)
        square += self.symmetrized
        square *= factor
        square[np.diag_indices(self.n)] += diagonal
        return square

    def augmented(
        self, factor: float, shift: float, columns: Array, diagonal: Array, z2: Array, w: Array, turn: Array | None
    ) -> Matrix:
        """``[[factor (A + A') + shift I, -factor A'], [diag(z2) A, diag(w)]]``, the first n columns scaled.

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
        n = self.n
        if self.problem.sparse:
            scaling = sp.diags_array(columns)
            top = (factor * self.symmetrized + shift * sp.eye_array(n)) @ scaling + sp.diags_array(diagonal)
            bottom = sp.diags_array(z2) @ self.problem.A @ scaling
            turned = self.transpose if turn is None else self.transpose @ sp.diags_array(turn)
            return sp.block_array([[top, -factor * turned], [bottom, sp.diags_array(w)]], format="csc")
        whole = np.empty((2 * n, 2 * n), order="F")
        whole[:n, :n] = factor * self.symmetrized * columns
        whole[:n, n:] = -factor * (self.transpose if turn is None else self.transpose * turn)
        whole[n:, :n] = z2[:, None] * self.problem.A * columns
        whole[n:, n:] = np.diag(w)
        first = np.arange(n)
        whole[first, first] += shift * columns + diagonal
        return whole
