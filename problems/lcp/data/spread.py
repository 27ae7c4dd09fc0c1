"""The spread of entries, which decides on scaling."""

from __future__ import annotations

import numpy as np

from continuation.arrays import largest, least
from problems.lcp.data.problem import MixedLCP

EXTREME = 1e90
"""Products of three entries between this and its inverse are floats."""

UNIT_SPREAD = 256.0
"""Problems within this factor stay unscaled: units take 0.5 of 1.3 ms (n = 60), 0.25 of 0.45 s (n = 1000)."""


def near_one(problem: MixedLCP) -> bool:
    """Whether A's largest entry is neither extreme nor its square."""
    return bool(EXTREME**-0.5 <= largest_entries(problem)[1] <= EXTREME**0.5)


def alike(problem: MixedLCP) -> bool:
    """Whether largest entries are within `UNIT_SPREAD` of each other."""
    least, most = largest_entries(problem)
    return 0.0 < most <= UNIT_SPREAD * least


def largest_entries(problem: MixedLCP) -> tuple[float, float]:
    """The least and the largest of the largest absolute entries of all rows and columns of A."""
    if "range" not in problem.known:
        problem.known["range"] = _found_entries(problem)
    found: tuple[float, float] = problem.known["range"]
    return found


def _found_entries(problem: MixedLCP) -> tuple[float, float]:
    sizes = abs(problem.A)
    most = [sizes.max(axis=0), sizes.max(axis=1)]
    both = np.concatenate([one.toarray() for one in most] if problem.sparse else most)
    return least(both), largest(both)


def extreme(problem: MixedLCP) -> bool:
    """Whether products of three entries may overflow or vanish."""
    size = np.abs(np.concatenate([problem.A.data if problem.sparse else problem.A.ravel(), problem.q]))
    return bool(((size > EXTREME) | ((size > 0.0) & (size < 1.0 / EXTREME))).any())
