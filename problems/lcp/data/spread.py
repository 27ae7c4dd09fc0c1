"""The spread of entries decides on scaling."""

from __future__ import annotations

import numpy as np

from continuation.arrays import largest, least
from problems.lcp.data.problem import MixedLCP

EXTREME = 1e90
"""Products of three entries between this and its inverse are floats."""

LEVELLED = 16.0
"""Problems with bounds stay unscaled if rows' and columns' largest entries are within this factor of each other and of
1: scaling takes 0.25 of 0.45 s (n = 1000)."""

UNIT_SPREAD = 256.0
"""LCPs stay unscaled for active sets and pivots within this factor: units take 0.5 of 1.3 ms (n = 60)."""


def level(problem: MixedLCP) -> bool:
    """Whether largest entries are within `LEVELLED` of each other and of 1."""
    least, most = largest_entries(problem)
    return most <= LEVELLED * least and 1.0 / LEVELLED <= most <= LEVELLED


def alike(problem: MixedLCP) -> bool:
    """Whether largest entries are within `UNIT_SPREAD` of each other."""
    least, most = largest_entries(problem)
    return 0.0 < most <= UNIT_SPREAD * least


def largest_entries(problem: MixedLCP) -> tuple[float, float]:
    """The least and the largest among the largest absolute entries of all rows and columns of A."""
    if "range" not in problem.known:
        problem.known["range"] = _found_entries(problem)
    found: tuple[float, float] = problem.known["range"]
    return found


def _found_entries(problem: MixedLCP) -> tuple[float, float]:
    if problem.sparse:
        entries, both = np.abs(problem.A.data), np.zeros(2 * problem.n)
        np.maximum.at(both, np.repeat(np.arange(problem.n), np.diff(problem.A.indptr)), entries)
        np.maximum.at(both, problem.n + problem.A.indices, entries)
    else:
        A = problem.A
        both = np.concatenate([np.maximum(np.maximum.reduce(A, k), -np.minimum.reduce(A, k)) for k in (0, 1)])
    return least(both), largest(both)


def extreme(problem: MixedLCP) -> bool:
    """Whether products of three entries may overflow or vanish."""
    size = np.abs(np.concatenate([problem.A.data if problem.sparse else problem.A.ravel(), problem.q]))
    size = size if np.count_nonzero(size) == size.size else size[size > 0.0]
    return bool(size.size) and (largest(size) > EXTREME or least(size) < 1.0 / EXTREME)
