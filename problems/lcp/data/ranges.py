"""Two-sided rows, low <= G x <= high: an activity r = G x in [low, high] and a free multiplier mu.

The row of r holds only mu, and its column meets only mu's row, so r is in no factored matrix.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import MixedLCP

Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]


@frozen(eq=False)
class Ranges:
    """Pairs with ``w_r = up mu + q_r`` and ``w_mu = ... + down r + q_mu``, mu without bounds.

    `activity`, `multiplier`: The r and mu. `up`, `down`: A[r, mu], A[mu, r]. `rest`: Indices without r. `place`:
    Positions of mu in `rest`.
    """

    A: Matrix
    activity: Indices
    multiplier: Indices
    up: Array
    down: Array
    rest: Indices
    place: Indices

    def shifts(self, shift: float) -> Array:
        """The diagonal shift of a proximal problem: zero for r."""
        each = np.full(self.A.shape[0], shift)
        each[self.activity] = 0.0
        return each

    def inside(self, active: Mask) -> Indices:
        """Active indices to solve together: pairs with active r are left out."""
        kept = active.copy()
        loose = active[self.activity]
        kept[self.activity] = False
        kept[self.multiplier[loose]] = False
        return np.flatnonzero(kept)

    def completed(
        self, active: Mask, inside: Indices, solve: Callable[[Array], Array], shift: float
    ) -> Callable[[Array], Array]:
        """Extend a solve on `inside` to the active set: r's row gives mu, mu's row gives r."""
        loose = active[self.activity]
        r, mu = self.activity[loose], self.multiplier[loose]

        def inverse(right: Array) -> Array:
            whole, z = np.zeros(active.size), np.zeros(active.size)
            whole[active] = right
            z[mu] = whole[r] / self.up[loose]
            left = whole - self.A @ z
            if inside.size:
                z[inside] = solve(left[inside])
            z[r] = (whole[mu] - (self.A @ z)[mu] - shift * z[mu]) / self.down[loose]
            return z[active]

        return inverse


def ranges(problem: MixedLCP) -> Ranges | None:
    """A problem's pairs, or None."""
    if problem.standard:
        return None
    free = np.isinf(problem.lower) & np.isinf(problem.upper)
    boxed = np.flatnonzero(np.isfinite(problem.lower) & np.isfinite(problem.upper))
    if not boxed.size or not free.any():
        return None
    A = problem.A
    mu, up = _only(A[boxed])
    other, down = _only(A[:, boxed].T)
    found = (mu == other) & (mu >= 0)
    found[found] = free[mu[found]]
    # Two activities may not share a multiplier.
    found[found] = np.bincount(mu[found], minlength=problem.n)[mu[found]] == 1
    if not found.any():
        return None
    r, mu = boxed[found], mu[found]
    rest = np.setdiff1d(np.arange(problem.n), r)
    return Ranges(A, r, mu, up[found], down[found], rest, np.searchsorted(rest, mu))


def _only(rows: Matrix) -> tuple[Indices, Array]:
    """Column and value of each row's only nonzero; -1 for others."""
    entries = sp.csr_array(rows)
    entries.eliminate_zeros()
    one = np.diff(entries.indptr) == 1
    column, value = np.full(one.size, -1, dtype=np.intp), np.zeros(one.size)
    column[one], value[one] = entries.indices[entries.indptr[:-1][one]], entries.data[entries.indptr[:-1][one]]
    return column, value
