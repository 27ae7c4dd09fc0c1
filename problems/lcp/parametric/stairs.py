"""The graph of each pair (x_i, w_i): three pieces that meet at two corners, some of which may be absent.

A bound fixes x_i on the outer pieces and w_i on the one between; a level t |x_i| fixes x_i = 0 on the one between, and
w_i = -t, t on the outer ones. On each piece one of the two is fixed, and the other moves between limits.
"""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP, State

Mask = NDArray[np.bool_]


@frozen(eq=False)
class Stairs:
    """What is fixed and what may move, by state (row state + 1) and index: all of shape (3, n).

    `moves_x`: Whether x_i moves, and w_i is fixed; else the other way round. `values`, of shape (6, 3, n): The value of
    what is fixed is ``values[0] + t values[1]``; the limits of what moves are ``values[2] + t values[4]`` and
    ``values[3] + t values[5]``. `levels`, of shape (n,): Where an outer piece fixes w_i. `corner_x`, `corner_slope`, of
    shape (2, n): The corners, infinite where there is none: w_i is ``t corner_slope`` there.
    """

    moves_x: Mask
    values: Array
    levels: Mask
    corner_x: Array
    corner_slope: Array

    @classmethod
    def of(cls, problem: MixedLCP, level: Array) -> Self:
        """The graphs of a problem with bounds, and with ``t level_i |x_i|`` where the level is positive.

        `level`, of shape (n,): Zero where there is a bound.
        """
        n = problem.n
        levels = level > 0.0
        corner_x = np.array([np.where(levels, 0.0, problem.lower), np.where(levels, 0.0, problem.upper)])
        slope = np.array([level, -level])
        zero, infinite = np.zeros(n), np.full(n, np.inf)
        # From the right of one corner to the left of the next x grows, and downwards from one to the next w falls.
        left = np.array([-infinite, corner_x[0], corner_x[1]])
        right = np.array([corner_x[0], corner_x[1], infinite])
        bottom, top = np.array([zero, zero, -infinite]), np.array([infinite, zero, zero])
        moves_x = np.array([levels, ~levels, levels])
        bottom[0, problem.fixed] = -np.inf
        # Outer pieces at bounds that are infinite are never entered: no limit leads to them.
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
        """On which piece each pair of a solution is, with x moving only where it is off its bounds, or off zero.

        `x`, of shape (n,): Exactly on the bounds where it is on them.
        """
        bounded = np.where(x <= problem.lower, -1, np.where(x >= problem.upper, 1, 0))
        found: State = np.where(self.levels, np.sign(x), bounded).astype(np.int8)
        return found
