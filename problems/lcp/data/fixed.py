"""Removes unknowns with equal bounds."""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP


@frozen(eq=False)
class WithoutFixed:
    """A problem without its fixed unknowns: `problem` is the rest, with q rounded; `kept` are the indices."""

    whole: MixedLCP
    problem: MixedLCP
    kept: NDArray[np.intp]

    def x(self, rest: Array) -> Array:
        """All unknowns, from those of the rest."""
        x = self.whole.lower.copy()
        x[self.kept] = rest
        return x


def without_fixed(problem: MixedLCP) -> WithoutFixed:
    """Take the fixed unknowns into q."""
    kept = np.flatnonzero(~problem.fixed)
    q = problem.w(np.where(problem.fixed, problem.lower, 0.0))[kept]
    block = problem.A[kept][:, kept]
    primal = int(np.searchsorted(kept, problem.primal))
    rest = MixedLCP(block, q, problem.lower[kept], problem.upper[kept], primal=primal)
    return WithoutFixed(problem, rest, kept)
