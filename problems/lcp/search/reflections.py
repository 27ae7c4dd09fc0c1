"""Douglas and Rachford's iteration between two sets: the points with w = A x + q, and those with complementary pairs.

The first set is affine; in the second each pair (x_i, w_i) has its own nearest point. Nothing guarantees convergence,
but only solutions are fixed points. Random problems neither monotone nor P take 0.3 s (n = 300), by restarts 60.

References
----------
Elser, Rankenburg and Thibault, PNAS 104, 2007; Aragon Artacho, Campoy and Tam, Math. Methods Oper. Res. 91, 2020.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import scipy.linalg as sl
from attrs import define, frozen
from numpy.typing import NDArray

from continuation.arrays import Array, largest
from problems.lcp.data.problem import BETWEEN, LOWER, UPPER, MixedLCP, State
from problems.lcp.search.search import Search
from problems.lcp.search.work import default_budget

Single = NDArray[np.float32]

RUNS_AT_ONCE = 16
"""The slowest of 24 Gaussian problems, n = 200, takes 2.1 s with two runs, 0.16 with sixteen."""

CHECKED = 25
"""Iterations between comparisons of faces: unchanged faces are tried."""

LARGEST_REFLECTED = 1000
"""Largest order: a round takes a minute there; Gaussian problems need 5 to 17 s."""

ROUND_WORK = 4e8
"""Least iterations times n^2 of a round, 1.3 s."""


def run_length(n: int) -> int:
    """Iterations of a round: Gaussian problems need 300 (n = 100), 3,000 (600)."""
    return 1000 + 10 * n


@frozen(eq=False)
class Sets:
    """The two sets, in units that weigh w like x.

    `onto` projects onto differences of points with w = A x + q. Its point `nearest` is nearest to w = 0 and to the x
    nearest to zero, from which bounds count.
    """

    onto: Single
    nearest: Single
    lower: Single
    upper: Single
    standard: bool

    @classmethod
    def of(cls, problem: MixedLCP) -> Sets | None:
        """The sets of a problem; None without a finite, positive unit of length."""
        A, n = problem.A.toarray() if problem.sparse else problem.A, problem.n
        # The median ignores a large rank-one term.
        diagonal = np.abs(sl.qr(A, mode="r", check_finite=False)[0].diagonal())
        unit = float(np.median(diagonal)) or largest(diagonal) or 1.0
        basis = sl.qr(np.vstack([np.eye(n), A / unit]), mode="economic", overwrite_a=True, check_finite=False)[0]
        onto, origin = basis @ basis.T, problem.near_zero
        nearest = np.append(np.zeros(n), problem.w(origin) / unit)
        nearest -= onto @ nearest
        length = float(np.abs(nearest).mean())
        if not 0.0 < length < math.inf:
            return None
        lower, upper = (_single((end - origin) / length) for end in (problem.lower, problem.upper))
        return cls(onto.astype(np.float32), _single(nearest / length), lower, upper, problem.standard)

    def rounds(self, random: np.random.Generator) -> Iterator[tuple[int, list[State]]]:
        """Yield without end the rounds done and the faces kept."""
        n, over = self.lower.size, 0
        while True:
            z = random.standard_normal((2 * n, RUNS_AT_ONCE), np.float32)
            before = np.full((n, RUNS_AT_ONCE), UPPER + 1, dtype=np.int8)
            for k in range(1, run_length(n) + 1):
                a = self.onto @ z
                a += self.nearest
                state, b = self._complementary(2.0 * a - z)
                b -= a
                z += b
                if k % CHECKED == 0:
                    stay = np.flatnonzero((state == before).all(axis=0))
                    yield over, [state[:, j].copy() for j in stay]
                    before = state
            over += 1

    def _complementary(self, z: Single) -> tuple[NDArray[np.int8], Single]:
        n = self.lower.size
        x, w = z[:n], z[n:]
        if self.standard:
            inside = x > w
            b = np.maximum(z, 0.0)
            b[:n] *= inside
            b[n:] *= ~inside
            return np.where(inside, BETWEEN, LOWER), b
        between = np.clip(x, self.lower, self.upper)
        off = (x - between) ** 2 + w**2
        below = (x - self.lower) ** 2 + np.minimum(w, 0.0) ** 2
        above = (x - self.upper) ** 2 + np.maximum(w, 0.0) ** 2
        low, high = (below < off) & (below <= above), (above < off) & (above < below)
        b = np.empty_like(z)
        b[:n] = np.where(low, self.lower, np.where(high, self.upper, between))
        b[n:] = np.where(low, np.maximum(w, 0.0), np.where(high, np.minimum(w, 0.0), 0.0))
        return np.where(low, LOWER, np.where(high, UPPER, BETWEEN)), b


def reflectable(search: Search) -> bool:
    """Whether reflections are tried: n is small enough to project on w = A x + q, and A is not semidefinite."""
    return search.finish is not None and search.problem.n <= LARGEST_REFLECTED and not search.structure.semidefinite


@define(eq=False)
class Reflections:
    """One problem's runs."""

    search: Search
    _runs: Iterator[tuple[int, list[State]]] | None = None

    def run(self, work: float) -> str:
        """Run up to `work` rounds, fewer if n is large."""
        search, n = self.search, self.search.problem.n
        if self._runs is None:
            sets = Sets.of(search.problem)
            self._runs = iter(()) if sets is None else sets.rounds(np.random.default_rng(search.asked.seed))
        share = min(1.0, search.budget.factorizations / default_budget(search.problem).factorizations)
        rounds = min(work, work * ROUND_WORK / (run_length(n) * n * n)) * share
        for over, faces in self._runs:
            if any(search.settle(face) for face in faces):
                seed = search.asked.seed
                return f"Solved by reflections between w = A x + q and the complementary pairs (seed {seed})."
            if over >= max(rounds, 1) or search.exhausted:
                break
        return ""


def _single(values: Array) -> Single:
    return values.astype(np.float32)[:, None]
