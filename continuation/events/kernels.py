"""Kernels of H' where it loses several ranks: bases of both, and how many ranks they say are lost."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import splu

from continuation.arrays import Array, Matrix
from continuation.linear.entries import extended

BORDERS = 5
"""Lost ranks that can be counted: two more than are resolved (`continuation.events.multiple`), so that the message is
right."""

RANK = 1e-6
"""What may be left of a singular value, relative to the matrix, where it is said to vanish: as for simple branch
points."""


@frozen(eq=False)
class Doubled:
    """A matrix bordered by columns and rows so that it is square, and factored."""

    matrix: Matrix
    columns: Array
    rows: Array

    def factors(self) -> Callable[[Array, bool], Array]:
        """The solution of the system for a right-hand side, or of its transpose."""
        corner = np.zeros((len(self.rows), self.columns.shape[1]))
        whole = extended(self.matrix, self.columns, np.hstack([self.rows, corner]))
        if sp.issparse(whole):
            factored = splu(whole)
            return lambda r, transposed: np.asarray(factored.solve(r, "T" if transposed else "N"))
        factors = lu_factor(whole, check_finite=False)
        return lambda r, transposed: np.asarray(lu_solve(factors, r, int(transposed), check_finite=False))


def kernels(matrix: Matrix, accuracy: float = RANK) -> tuple[Array, Array]:
    """Orthonormal bases of the kernel of a matrix, shape (N, N + 1), and of its left kernel, as columns.

    With as many borders in general position as ranks may be lost the bordered matrix is regular, and what it makes of
    unit vectors spans the kernels (Govaerts, Section 3.3).

    Parameters
    ----------
    matrix : ndarray or sparse array
    accuracy : float
        What may be left of a singular value that vanishes.
    """
    n = matrix.shape[0]
    k = min(BORDERS, n)
    generator = np.random.default_rng(7)
    columns, rows = generator.standard_normal((n, k)), generator.standard_normal((k + 1, n + 1))
    solve = Doubled(matrix, columns, rows).factors()
    right = solve(np.vstack([np.zeros((n, k + 1)), np.eye(k + 1)]), False)
    left = solve(np.vstack([np.zeros((n + 1, k)), np.eye(k)]), True)
    return _vanishing(right[: n + 1], right[n + 1 :], accuracy), _vanishing(left[:n], left[n:], accuracy)


def _vanishing(vectors: Array, left_over: Array, accuracy: float) -> Array:
    """Those combinations of vectors that leave nothing."""
    values, turned = np.linalg.svd(left_over)[1:]
    rank = int(np.count_nonzero(values > accuracy * np.linalg.norm(vectors, 2)))
    basis: Array = np.linalg.qr(vectors @ turned[rank:].T)[0]
    return basis
