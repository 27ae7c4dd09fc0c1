"""Iterations that add increments until one is small: one loop, and the ratios at which they are given up.

An iteration whose increments shrink by a ratio q < 1 is, after an increment d, within q / (1 - q) |d| of its limit
(Banach's fixed-point theorem); so the ratio says what the last increment is worth.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import define, frozen

from continuation.arrays import Array

HALVING = 0.5
"""At this ratio the last increment is itself a bound of the error. Iterative refinement is stopped there (Higham,
Accuracy and Stability of Numerical Algorithms, Section 12.1; LAPACK's xGERFS), and so are chord steps here."""

RELIABLE = 0.3
"""Where more hangs on it than one more factorisation: the sign of a determinant that is read off a factorisation from
nearby, the coefficients of a series, the branch on which a path lands."""

MONOTONE = 0.9
"""Increments that merely fall, and do not crawl: Deuflhard's monotonicity test (Newton Methods for Nonlinear Problems,
Section 2.1) for an iteration whose limit is examined afterwards."""


@frozen
class Contraction:
    """When an iteration is given up.

    `iterations`: At most so many increments. `ratio`: An increment larger than this, relative to the one before, is not
    added any more. `first`: The same for the first two increments, which may be of unlike parts of the error; `ratio`
    unless given. `noise`: Increments up to this size may be round-off: their ratios mean nothing, and are not looked
    at.
    """

    iterations: int
    ratio: float = HALVING
    first: float | None = None
    noise: float = 0.0


@define(eq=False)
class Iteration:
    """An iteration under way; what it has come to is to be read off it, also where an increment raised.

    `x`: The iterate. `size`: Of the last increment that was added. `ratio`, `worst`: Of the last two increments, and
    the largest so far that was looked at. `count`: Increments computed. `stalled`: Whether it was given up for its
    ratio.
    """

    x: Array
    rule: Contraction
    size: float = np.inf
    ratio: float = 0.0
    worst: float = 0.0
    count: int = 0
    stalled: bool = False

    def add(self, step: Array, size: float) -> bool:
        """Add an increment of a size; False, and nothing is added, if the iteration is given up for it."""
        rule, k, before = self.rule, self.count, self.size
        self.count = k + 1
        if k:
            self.ratio = ratio = size / before if before > 0.0 else np.inf
            if size > rule.noise:
                if ratio > self.worst:
                    self.worst = ratio
                if ratio > (rule.ratio if k > 1 or rule.first is None else rule.first):
                    self.stalled = True
                    return False
        self.x = self.x + step
        self.size = size
        return True

    def run(
        self, increment: Callable[[], Array], measure: Callable[[Array], float], done: Callable[[float], bool]
    ) -> bool:
        """Add increments; whether it is done. What every step does is a loop of its own over `add`, for its time.

        `increment`: The next increment at `x`. `measure`: Its size. `done`: Whether an increment of that size, which
        has been added, was the last.
        """
        self.count = 0
        while self.count < self.rule.iterations:
            step = increment()
            size = measure(step)
            if not self.add(step, size):
                return False
            if done(size):
                return True
        return False
