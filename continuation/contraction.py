"""Iterations that add increments until one is small.

After increment d the error is at most q / (1 - q) |d| if increments shrink by a ratio q < 1 (Banach's theorem).
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from attrs import define, frozen

from continuation.arrays import Array, dot

HALVING = 0.5
"""Ratio up to which the last increment bounds the error (Higham, Accuracy and Stability of Numerical Algorithms,
Section 12.1; LAPACK's xGERFS)."""

RELIABLE = 0.3
"""Ratio for determinant signs, series coefficients, landings."""

MONOTONE = 0.9
"""Deuflhard's monotonicity test (Newton Methods for Nonlinear Problems, Section 2.1), if the result is checked."""


@frozen
class Contraction:
    """When an iteration gives up.

    `iterations`: limit; twenty halvings give six digits. `ratio`: largest ratio of increments. `first`: largest first
    ratio, if different. `noise`: smaller increments are round-off.
    """

    iterations: int = 20
    ratio: float = HALVING
    first: float | None = None
    noise: float = 0.0


@define(eq=False)
class Iteration:
    """State of an iteration.

    `size`: last added increment. `ratio`, `worst`: last and largest ratio. `count`: increments computed. `stalled`:
    stopped for its ratio.
    """

    x: Array
    rule: Contraction
    size: float = np.inf
    ratio: float = 0.0
    worst: float = 0.0
    count: int = 0
    stalled: bool = False

    @property
    def error(self) -> float:
        """Bound of the error; before three increments no ratio is known to be the largest."""
        return self.size if self.count < 3 else self.size * min(self.worst / max(1.0 - self.worst, HALVING), 1.0)

    def add(self, step: Array, size: float) -> bool:
        """Add an increment to `x`; False, without adding, if the ratio of sizes is too large."""
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
        """Add increments; return whether done.

        `increment`: the next at `x`. `measure`: its size. `done`: whether a size ends the iteration.
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


def updated(increments: list[tuple[Array, Array]], z: Array, weights: Array) -> Array:
    """The chord increment z after Broyden's good update, which all `increments` since the factorisation define.

    It is appended to `increments`, with its dual; they are emptied first if they are round-off (Kelley, Iterative
    Methods for Linear and Nonlinear Equations, Section 7.3). An update multiplies the determinant by `left`; none turns
    its sign.
    """
    for (_, dual), (after, _) in pairwise(increments):
        z = z + dot(dual, z) * after
    if increments:
        left = 1.0 - dot(increments[-1][1], z)
        if left < 1.0 - MONOTONE:
            # Round-off contains nothing about the matrix.
            increments.clear()
        else:
            z = z / left
    weighted = weights * z
    if (square := dot(weighted, z)) > 0.0:
        increments.append((z, weighted / square))
    return z
