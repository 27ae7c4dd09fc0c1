"""Descent of the sum of c_i min(x_i, w_i) over x >= 0, w >= 0, with weights c that grow where it stops.

The sum is concave: with the smaller one of each pair in place of the minimum it is linear, and a linear program leads
to a vertex where it is less, unless it is least there. A vertex where it is zero is a solution. At another the pairs
with x_i > 0 and w_i > 0 gain weight until it is no longer least, so that the search goes on from where it is.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.almost import PATH_LEFT, REBUILT_AFTER
from problems.lcp.pivoting.dictionary import Dictionary
from problems.lcp.pivoting.programs import ROUNDED_TO_ZERO, cheapest, infeasible_row, point_of, vertex_at_zero

GAIN = 1.0
"""What the weight of the pair that is off most grows by, times a number at random between 0 and 2, others by the root
of how far they are off."""

LONGEST = 500
"""Linear programs after which weights begin anew. On 12 Gaussian problems (n = 100), 6,000 programs each, 9 are solved;
with 2000 6, as without the random numbers, with which no few vertices follow each other again and again."""

LIGHTEST = 1e-6
"""Weights are between this and its inverse, with mean logarithm 0."""

FIRST_SPREAD, NEXT_SPREAD = 1.0, 0.5
"""Of the decimal logarithms of costs at the beginning, and of weights that begin anew."""


@define(eq=False)
class Descents:
    """The search on one problem; each run goes on where the last one ended.

    Attributes
    ----------
    problem : LCP
        Dense, and in units in which its entries are about 1.
    accepts : callable
        Whether the face with these w_i = 0 holds a solution.
    seed : int
    programs : int
        Linear programs so far.
    """

    problem: LCP
    accepts: Callable[[NDArray[np.bool_]], bool]
    seed: int
    programs: int = field(default=0, init=False)
    _random: np.random.Generator = field(init=False)
    _weights: Array = field(init=False)
    _vertex: Dictionary | None = field(default=None, init=False)
    _since: int = field(default=0, init=False)

    def __attrs_post_init__(self) -> None:
        self._random, self._weights = np.random.default_rng(self.seed), np.ones(self.problem.n)

    def run(self, most: int, seconds: float = math.inf) -> bool:
        """Go on until there have been so many linear programs; whether a face was accepted.

        Parameters
        ----------
        most : int
        seconds : float
        """
        end = time.perf_counter() + seconds
        while self.programs < most and time.perf_counter() < end:
            if self._vertex is None and not self._begun():
                return False
            assert self._vertex is not None
            x, w = point_of(self._vertex)
            off = np.minimum(x, w)
            worst = float(off.max())
            if worst <= ROUNDED_TO_ZERO * max(float(x.max()), float(w.max())):
                if self.accepts(x > w):
                    return True
                self._vertex = None
                continue
            if self.programs % LONGEST == LONGEST - 1:
                self._weights = 10.0 ** self._random.uniform(-NEXT_SPREAD, NEXT_SPREAD, off.size)
            shares = np.sqrt(np.maximum(off, 0.0) / worst)
            self._weights *= 1.0 + GAIN * self._random.uniform(0.0, 2.0, off.size) * shares
            self._weights /= math.exp(float(np.log(self._weights).mean()))
            np.clip(self._weights, LIGHTEST, 1.0 / LIGHTEST, out=self._weights)
            self._go_on(x > w)
        return False

    def _begun(self) -> bool:
        """Find a vertex; whether there is one."""
        n = self.problem.n
        self._vertex = vertex_at_zero(self.problem, 10.0 ** self._random.uniform(-FIRST_SPREAD, 0.0, n))
        self.programs, self._since = self.programs + 1, 0
        return infeasible_row(self._vertex, np.zeros(2 * n + 1, dtype=bool)) == -1

    def _go_on(self, active: NDArray[np.bool_]) -> None:
        """To the vertex that is least in the smaller one of each pair."""
        assert self._vertex is not None
        weights = self._weights
        pivots = cheapest(self._vertex, np.append(np.where(active, 0.0, weights), np.where(active, weights, 0.0)))
        self.programs += 1
        if pivots is None:
            self._vertex = None
            return
        self._since += pivots
        if self._since > REBUILT_AFTER + active.size:
            self._since = 0
            # The cost is not less than zero.
            if not self._vertex.rebuilt() >= PATH_LEFT:
                self._vertex = None
