"""The graph of each pair (x_i, w_i): up to three pieces.

A bound fixes x_i on outer pieces and w_i between; a level fixes x_i = 0 between, and w_i outside.
"""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Mask
from problems.lcp.data.problem import MixedLCP, State


@frozen(eq=False)
class Stairs:
    """Fixed values and limits, by state (row state + 1) and index.

    `moves_x`: whether x_i moves and w_i is fixed, or vice versa. The fixed value is ``values[0] + t values[1]``, the
    limits are ``values[2] + t values[4]`` and ``values[3] + t values[5]``. `levels`: whether outer pieces fix w_i.
    Corners, infinite if absent, have w_i = ``t corner_slope``.
    """

    moves_x: Mask
    values: Array
    levels: Mask
    corner_x: Array
    corner_slope: Array

    @classmethod
    def of(cls, problem: MixedLCP, level: Array) -> Self:
        """The graphs; `level` is zero at bounds."""
        n = problem.n
        levels = level > 0.0
        corner_x = np.array([np.where(levels, 0.0, problem.lower), np.where(levels, 0.0, problem.upper)])
        slope = np.array([level, -level])
        zero, infinite = np.zeros(n), np.full(n, np.inf)
        left = np.array([-infinite, corner_x[0], corner_x[1]])
        right = np.array([corner_x[0], corner_x[1], infinite])
        bottom, top = np.array([zero, zero, -infinite]), np.array([infinite, zero, zero])
        moves_x = np.array([levels, ~levels, levels])
        bottom[0, problem.fixed] = -np.inf
        # Outer pieces at infinite bounds are never entered.
        outer_x = np.array([corner_x[0], zero, corner_x[1]])
        values: list[tuple[Any, Any]] = [
            (0.0, np.where(np.isfinite(outer_x), outer_x, 0.0)),
            (np.array([slope[0], zero, slope[1]]), 0.0),
            (left, bottom),
            (right, top),
            (0.0, np.array([slope[0], slope[1], zero])),
            (0.0, np.array([zero, slope[0], slope[1]])),
        ]
        return cls(moves_x, np.array([np.where(moves_x, *pair) for pair in values]), levels, corner_x, slope)

    def states(self, problem: MixedLCP, x: Array) -> State:
        """Pieces of a solution x, exactly at its bounds."""
        bounded = np.where(x <= problem.lower, -1, np.where(x >= problem.upper, 1, 0))
        found: State = np.where(self.levels, np.sign(x), bounded).astype(np.int8)
        return found
