"""SuperLU: factors of any sparse matrix, with the sign of its determinant."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from continuation.arrays import Matrix


def permutation_sign(permutation: NDArray[np.integer]) -> int:
    """Sign of a permutation of 0..n-1: (-1)^(n - cycles), in O(n).

    Parameters
    ----------
    permutation : ndarray of int
    """
    n = len(permutation)
    edges = coo_array((np.ones(n, dtype=np.int8), (np.arange(n), permutation)), shape=(n, n))
    cycles: int = connected_components(edges, directed=False, return_labels=False)
    return -1 if (n - cycles) % 2 else 1


def superlu_sign(lu: Any) -> int:
    """Sign of the determinant, from pivots and permutations."""
    negative = np.count_nonzero(lu.U.diagonal() < 0)
    exchanges = permutation_sign(lu.perm_r) * permutation_sign(lu.perm_c)
    return -exchanges if negative % 2 else exchanges


def factor_superlu(matrix: Matrix, **how: Any) -> Any:
    """SuperLU factors of a csc matrix; None if a pivot is zero."""
    try:
        return splu(matrix, **how)
    except RuntimeError as error:
        if "singular" not in str(error):
            raise
        return None


def definite(matrix: Matrix) -> bool:
    """Whether a symmetric csc matrix is positive definite: elimination without exchanges meets only positive pivots."""
    lu = factor_superlu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    if lu is None:
        return False
    return bool((lu.U.diagonal() > 0.0).all() and (lu.perm_r == lu.perm_c).all())
