"""SuperLU, which comes with scipy: factors of any sparse matrix, with the sign of its determinant."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

import numpy as np
from attrs import frozen
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from continuation.arrays import Array, Matrix
from continuation.linear.look import Look


def permutation_sign(permutation: NDArray[np.integer]) -> int:
    """Sign of a permutation of 0..n-1: (-1)^(n - cycles), in O(n).

    The cycles are the connected components of the graph that joins i with permutation[i].

    Parameters
    ----------
    permutation : ndarray of int
    """
    n = len(permutation)
    edges = coo_array((np.ones(n, dtype=np.int8), (np.arange(n), permutation)), shape=(n, n))
    cycles: int = connected_components(edges, directed=False, return_labels=False)
    return -1 if (n - cycles) % 2 else 1


@frozen(eq=False)
class SparseFactor:
    """A sparse matrix made ready for solves.

    Attributes
    ----------
    name : str
        Of what made it, as a message has it.
    solve : callable
        The solution of A x = rhs, shape (N,); `rhs` is not modified.
    fill : int
        How many numbers it holds; 0 where that is not told.
    tell_sign : callable
        The sign of det A, 0 where that is not known.
    """

    name: str
    solve: Callable[[Array], Array]
    fill: int
    tell_sign: Callable[[], int]

    @property
    def sign(self) -> int:
        """Sign of det A, worked out when it is asked for."""
        return self.tell_sign()


def superlu_sign(lu: Any) -> int:
    """Sign of the determinant of what SuperLU factored: from the pivots and the parity of both permutations."""
    negative = np.count_nonzero(lu.U.diagonal() < 0)
    exchanges = permutation_sign(lu.perm_r) * permutation_sign(lu.perm_c)
    return -exchanges if negative % 2 else exchanges


def factor_superlu(matrix: Matrix, **how: Any) -> SparseFactor | None:
    """Factors of a sparse (CSC) matrix by itself, with SuperLU's options; None where a pivot is exactly zero.

    Parameters
    ----------
    matrix : csc_array of shape (N, N)
    **how
        As for `scipy.sparse.linalg.splu`.
    """
    try:
        lu = splu(matrix, **how)
    except RuntimeError as error:
        if "singular" not in str(error):
            raise
        return None
    return SparseFactor("SuperLU", lu.solve, int(lu.nnz), partial(superlu_sign, lu))


@frozen
class SuperLUMethod:
    """Factorisations by SuperLU, which take any matrix.

    `weak_pivots`: On a symmetric pattern a pivot on the diagonal, however weak, keeps the ordering's fill, and is left
    to a refinement; other matrices are ordered by columns. Without it rows are exchanged.
    """

    name: ClassVar[str] = "superlu"
    weak_pivots: bool = True

    def factor(self, look: Look) -> SparseFactor | None:
        """The factors; None where a pivot is exactly zero."""
        if not self.weak_pivots:
            # On a face of a symmetric pattern this ordering fills half as much as the default one.
            return factor_superlu(look.matrix, permc_spec="MMD_AT_PLUS_A")
        if not look.symmetric_pattern:
            return factor_superlu(look.matrix, permc_spec="COLAMD")
        symmetric = {"SymmetricMode": True}
        return factor_superlu(look.matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options=symmetric)
