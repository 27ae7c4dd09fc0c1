"""The first active sets of a small dense LCP, before a search is made.

On a face x and w follow from one linear system; then an index belongs to the next face where x_i > w_i (Newton's method
on min(x, w)). If nothing changes, the point is judged. If no fewer indices change than at best three times, the sets
may cycle, and the search takes over.
"""

from __future__ import annotations

import time

import numpy as np
from scipy.linalg.lapack import dgesv

from continuation.arrays import Mask
from continuation.counts import Counts
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.proof.certificate import ROUND_OFF, certified
from problems.lcp.proof.verdict import LARGEST_DECIDED
from problems.lcp.search.outcome import Outcome, Solution

LARGEST = 100
"""Largest order, also of sparse matrices that `solve` makes dense: there calls take longer than arithmetic. A grid with
n = 100 takes 0.25 ms, 1.7 sparse."""

ZERO = "q >= 0, so x = 0 is a solution."
SETTLED = "Solved by active sets alone, before any path."
_SAID = {told: f"{Outcome.SOLVED} {told}" for told in (ZERO, SETTLED)}


def at_once(problem: MixedLCP, tolerance: float, active: Mask | None = None, told: str = "") -> Solution | None:
    """The solution from an active set (by default q < 0), or None; numpy's warnings are off.

    Bimatrix games, with a_11 = 0, are left to pivots.
    """
    n = problem.n
    if not isinstance(problem, LCP) or problem.sparse or n > LARGEST or problem.A[0, 0] == 0.0:
        return None
    began, A, q, counts, fewest, vain = time.perf_counter(), problem.A, problem.q, Counts(), n + 1, 0
    active = q < 0.0 if active is None else active
    while True:
        x, inside = np.zeros(n), active.nonzero()[0]
        if inside.size:
            solved, singular = dgesv(A if inside.size == n else A[inside][:, inside], q[inside])[2:]
            if singular:
                return None
            counts.factorizations += 1
            x[inside] = -solved
        w = A.dot(x) + q
        w[inside] = 0.0
        following = x > w
        wrong = int(np.count_nonzero(following != active))
        if wrong == 0:
            break
        fewest, vain = (wrong, vain) if wrong < fewest else (fewest, vain + 1)
        if vain == 3:  # of 300 P-matrices, n = 20, 225 are solved so, 154 after two, 274 after five
            return None
        active = following
    found = certified(problem, x)
    if not found.relative_residual <= min(tolerance, ROUND_OFF) or not found.solves(tolerance):
        return None
    if n <= LARGEST_DECIDED and not found.clearly_exact:
        return None
    message = f"{Outcome.SOLVED} {told}" if told else _SAID[SETTLED if inside.size else ZERO]
    return Solution(problem, Outcome.SOLVED, message, found, (), -1, counts, time.perf_counter() - began)
