"""Douglas and Rachford's iteration between two sets: the points with w = A x + q, and those with complementary pairs.

The first set is affine, and in the second each pair (x_i, w_i) has a nearest point of its own: a step is one product
with a matrix, a thousandth of a step of a path. Where a set is not convex nothing says that this converges. But only
solutions make it stand still, no local minimum holds it, and among random problems that are neither monotone nor P it
soon comes by one: n = 100 in 0.02 s, n = 300 in 0.3, n = 600 in 3, where paths from random starts take 1, 60 and more
than 300 (`examples/benchmarks/outside.py`). The faces that it stays at are tried exactly; it claims nothing itself.

References
----------
Elser, Rankenburg and Thibault, "Searching with iterated maps", PNAS 104, 2007. Aragon Artacho, Campoy and Tam, "The
Douglas-Rachford algorithm for convex and nonconvex feasibility problems", Math. Methods Oper. Res. 91, 2020.
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

Single = NDArray[np.float32]

RUNS_AT_ONCE = 16
"""Runs at once: of 24 Gaussian problems, n = 200, the slowest takes 2.1 s of two, 1.3 of eight and 0.16 of sixteen."""

CHECKED = 25
"""Iterations between two looks at the faces: 1 at n = 30 costs as much as 25 iterations. One that is the same at both
is tried; a run that has come to a solution stays at its face."""

LARGEST_REFLECTED = 1000
"""A round takes a minute at this order, of which Gaussian problems need 5 to 17 s."""

ROUND_WORK = 4e8
"""Iterations times n^2 that are one round at least: 1.3 s. From order 300 on a round is more, 16 s of order 600."""


def run_length(n: int) -> int:
    """Iterations after which all runs begin anew: that of 1,000 to 6,000 at n = 200 matters little.

    `n`: The order. Runs that solve a Gaussian problem need 100 (n = 30), 300 (100), 1,000 (300) and 3,000 (600).
    """
    return 1000 + 10 * n


@frozen(eq=False)
class Sets:
    """The two sets, in units in which w weighs as x.

    `onto`, shape (2 n, 2 n): Projects onto the differences of points with w = A x + q. `nearest`, shape (2 n, 1): The
    point of that set nearest to w = 0 and the x, between the bounds, nearest to zero; its mean entry is the unit of
    length. `lower`, `upper`, shape (n, 1): From that x. `standard`: Whether they are those of an `LCP`.
    """

    onto: Single
    nearest: Single
    lower: Single
    upper: Single
    standard: bool

    @classmethod
    def of(cls, problem: MixedLCP) -> Sets | None:
        """Those of a problem; None where w = A x + q lies so that there is no unit of length."""
        A, n = problem.A.toarray() if problem.sparse else problem.A, problem.n
        # A large factor of rank one, as games have for all costs to be positive, moves neither the median nor this.
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
        """Without end: how many rounds of runs are over, and the faces at which runs stay, `CHECKED` steps later."""
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
        """The nearest points with complementary pairs, and their faces."""
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
    """Where projections are no burden, and pivots do not end at a solution or a proof, as for a semidefinite A."""
    return search.finish is not None and search.problem.n <= LARGEST_REFLECTED and not search.facts.semidefinite


@define(eq=False)
class Reflections:
    """The runs of one problem, which go on where they were left."""

    search: Search
    _runs: Iterator[tuple[int, list[State]]] | None = None

    def run(self, work: float) -> str:
        """Until so many rounds of runs are over, of a large problem or within a small budget fewer, but one."""
        search, n = self.search, self.search.problem.n
        if self._runs is None:
            sets = Sets.of(search.problem)
            self._runs = iter(()) if sets is None else sets.rounds(np.random.default_rng(search.asked.seed))
        rounds = min(work, work * ROUND_WORK / (run_length(n) * n * n)) * search.share
        for over, faces in self._runs:
            if any(search.settle(face) for face in faces):
                seed = search.asked.seed
                return f"Solved by reflections between w = A x + q and the complementary pairs (seed {seed})."
            if over >= max(rounds, 1) or search.exhausted:
                break
        return ""


def _single(values: Array) -> Single:
    return values.astype(np.float32)[:, None]
