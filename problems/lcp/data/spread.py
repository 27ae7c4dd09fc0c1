"""How far apart the entries of a problem are, which decides whether units of its own are worth their time."""

from __future__ import annotations

import numpy as np

from continuation.arrays import largest, least
from problems.lcp.data.problem import MixedLCP

EXTREME = 1e90
"""Products of three entries below this, and above its inverse, are floats."""

LEVELLED = 16.0
"""Where the largest entries of all rows and columns are within this factor of another, and of 1, a problem with bounds
stays as it is. Finding units and changing to them takes longer than solving it then (n = 1000: 0.25 of 0.45 s)."""

UNIT_SPREAD = 256.0
"""Where they are within this factor of another, active sets and pivots are tried on an LCP as it is. Finding units
takes longer than that (monotone LCPs, n = 60: 0.5 of 1.3 ms), and two digits more or fewer decide nothing there; arches
of five stones have 50."""


ARRAY_ORDER = 100
"""Up to this order an array of the magnitudes costs less than the calls that do without; at n = 300 it is most of the
time."""


def level(problem: MixedLCP) -> bool:
    """Whether the largest entries of rows and columns are so alike that other units would change next to nothing."""
    least, most = largest_entries(problem)
    return most <= LEVELLED * least and 1.0 / LEVELLED <= most <= LEVELLED


def alike(problem: MixedLCP) -> bool:
    """Whether the largest entries of all rows and columns are within `UNIT_SPREAD` of another."""
    least, most = largest_entries(problem)
    return 0.0 < most <= UNIT_SPREAD * least


def largest_entries(problem: MixedLCP) -> tuple[float, float]:
    """The least and the largest of the largest entries of rows and columns; found once for a problem."""
    if "range" not in problem.known:
        problem.known["range"] = _found_entries(problem)
    found: tuple[float, float] = problem.known["range"]
    return found


def _found_entries(problem: MixedLCP) -> tuple[float, float]:
    if problem.sparse:
        entries, both = np.abs(problem.A.data), np.zeros(2 * problem.n)
        np.maximum.at(both, np.repeat(np.arange(problem.n), np.diff(problem.A.indptr)), entries)
        np.maximum.at(both, problem.n + problem.A.indices, entries)
    elif problem.n <= ARRAY_ORDER:
        sizes = np.abs(problem.A)
        both = np.concatenate([np.maximum.reduce(sizes, 0), np.maximum.reduce(sizes, 1)])
    else:
        A = problem.A
        both = np.concatenate([np.maximum(np.maximum.reduce(A, k), -np.minimum.reduce(A, k)) for k in (0, 1)])
    return least(both), largest(both)


def far_apart(problem: MixedLCP) -> bool:
    """Whether some entries are extreme beside others: `extreme`, whatever factor all of them have."""
    low, high = _range(problem)
    return high * (1.0 / EXTREME) > low


def extreme(problem: MixedLCP) -> bool:
    """Whether entries are so large, or so small, that products of three of them may overflow or vanish."""
    low, high = _range(problem)
    return high > EXTREME or low < 1.0 / EXTREME


def _range(problem: MixedLCP) -> tuple[float, float]:
    """The sizes of the least entry that is not zero and of the largest; 1 where there is none."""
    size = np.abs(np.concatenate([problem.A.data if problem.sparse else problem.A.ravel(), problem.q]))
    size = size if np.count_nonzero(size) == size.size else size[size > 0.0]
    return (least(size), largest(size)) if size.size else (1.0, 1.0)
