"""SuperLU: factors of any sparse matrix, with the sign of its determinant."""

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
    """A factored sparse matrix: `solve` keeps rhs, (N,); `fill`: entries; `tell_sign`: of det A; 0 if unknown."""

    name: str
    solve: Callable[[Array], Array]
    fill: int
    tell_sign: Callable[[], int]

    @property
    def sign(self) -> int:
        """Sign of det A."""
        return self.tell_sign()


def superlu_sign(lu: Any) -> int:
    """Sign of the determinant, from pivots and permutations."""
    negative = np.count_nonzero(lu.U.diagonal() < 0)
    exchanges = permutation_sign(lu.perm_r) * permutation_sign(lu.perm_c)
    return -exchanges if negative % 2 else exchanges


def factor_superlu(matrix: Matrix, **how: Any) -> SparseFactor | None:
    """SuperLU factors of a csc matrix; None if a pivot is zero."""
    try:
        lu = splu(matrix, **how)
    except RuntimeError as error:
        if "singular" not in str(error):
            raise
        return None
    return SparseFactor("SuperLU", lu.solve, int(lu.nnz), partial(superlu_sign, lu))


def definite(matrix: Matrix) -> bool:
    """Whether a symmetric csc matrix is positive definite: elimination without exchanges meets positive pivots only."""
    try:
        lu = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        return False
    return bool((lu.U.diagonal() > 0.0).all() and (lu.perm_r == lu.perm_c).all())


@frozen
class SuperLUMethod:
    """SuperLU, for any matrix.

    `weak_pivots`: keep weak diagonal pivots of symmetric patterns, to save fill; refinement corrects.
    """

    name: ClassVar[str] = "superlu"
    weak_pivots: bool = True

    def factor(self, look: Look) -> SparseFactor | None:
        """The factors; None if a pivot is zero."""
        if not self.weak_pivots:
            # MMD fills symmetric patterns half as much as the default.
            return factor_superlu(look.matrix, permc_spec="MMD_AT_PLUS_A")
        if not look.symmetric_pattern:
            return factor_superlu(look.matrix, permc_spec="COLAMD")
        symmetric = {"SymmetricMode": True}
        return factor_superlu(look.matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options=symmetric)
