"""Kernels and lost ranks of H', from one bordered matrix."""

from __future__ import annotations

import warnings
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from scipy.linalg import LinAlgWarning, lu_factor, lu_solve
from scipy.sparse.linalg import splu

from continuation.arrays import Array, Matrix
from continuation.linear.entries import extended

BORDERS = 5
"""Lost ranks that can be counted: two more than `continuation.events.multiple` resolves, for its message."""

RANK = 1e-6
"""Smaller singular values, relative to H', count as zero; the root of POLISHED is below."""


WEAK = 1e-8
"""A smaller pivot, relative to the largest, has the rank counted, which takes one factorisation more."""


@frozen(eq=False)
class Bordered:
    """[[H', B], [C, 0]], factored, with k columns B and k + 1 rows C: regular if H' has lost at most k ranks.

    It gives the null spaces (Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, Section 3.3).
    """

    matrix: Matrix
    columns: Array
    rows: Array

    @cached_property
    def _factor(self) -> Any:
        corner = np.zeros((len(self.rows), self.columns.shape[1]))
        whole = extended(self.matrix, self.columns, np.hstack([self.rows, corner]))
        if sp.issparse(whole):
            return splu(whole)
        with warnings.catch_warnings():
            warnings.simplefilter("error", LinAlgWarning)
            try:
                return lu_factor(whole, check_finite=False)
            except LinAlgWarning as warning:
                raise np.linalg.LinAlgError(str(warning)) from warning

    def solve(self, r: Array, transposed: bool = False) -> Array:
        """Solve the bordered system or its transpose."""
        if sp.issparse(self.matrix):
            x: Array = self._factor.solve(r, trans="T" if transposed else "N")
            return x
        y: Array = lu_solve(self._factor, r, trans=int(transposed), check_finite=False)
        return y

    @property
    def weak(self) -> bool:
        """Whether a pivot is so small that the bordered matrix may be singular, as it is if more ranks are lost."""
        factor = self._factor
        pivots = np.abs(factor.U.diagonal() if sp.issparse(self.matrix) else factor[0].diagonal())
        return bool(pivots.min() <= WEAK * pivots.max())

    @cached_property
    def left(self) -> tuple[Array, Array]:
        """Columns that span the left null space, and their defects (k + 1 numbers each)."""
        n, k = self.columns.shape
        found = self.solve(np.vstack([np.zeros((n + 1, k)), np.eye(k)]), transposed=True)
        return found[:n], found[n:]

    @cached_property
    def right(self) -> tuple[Array, Array]:
        """Columns that span the right null space, and their defects (k numbers each)."""
        n, k = self.columns.shape
        found = self.solve(np.vstack([np.zeros((n, k + 1)), np.eye(k + 1)]))
        return found[: n + 1], found[n + 1 :]

    def refreshed(self, matrix: Matrix) -> Bordered:
        """Another H', bordered with these null vectors: the best condition."""
        return Bordered(matrix, np.linalg.qr(self.left[0])[0], np.linalg.qr(self.right[0])[0].T)


def kernels(matrix: Matrix, accuracy: float = RANK) -> tuple[Array, Array]:
    """Orthonormal bases of both kernels of a matrix, shape (N, N + 1), as columns.

    `accuracy`: relative size of vanishing singular values.
    """
    n = matrix.shape[0]
    k = min(BORDERS, n)
    generator = np.random.default_rng(7)
    columns, rows = generator.standard_normal((n, k)), generator.standard_normal((k + 1, n + 1))
    bordered = Bordered(matrix, columns, rows)
    return _vanishing(*bordered.right, accuracy), _vanishing(*bordered.left, accuracy)


def _vanishing(vectors: Array, left_over: Array, accuracy: float) -> Array:
    values, turned = np.linalg.svd(left_over)[1:]
    rank = int(np.count_nonzero(values > accuracy * np.linalg.norm(vectors, 2)))
    basis: Array = np.linalg.qr(vectors @ turned[rank:].T)[0]
    return basis
