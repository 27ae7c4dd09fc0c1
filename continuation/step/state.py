"""The state of a trace between steps."""

from __future__ import annotations

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.predictors import Knot


@frozen(eq=False)
class State:
    """State at an accepted point; with the settings it determines the rest of the path.

    `history`: the predictor's knots, the current point last. `weights`: the metric. `anchor`: point and border that
    repeat the factorisation. `orientation`: see `Linearization`. `h`: the next step length. `monitors`, `occurrences`:
    values and counts of the events; a monitor that vanishes at the point is 0. `origin`: the start, with metric
    `origin_weights`. `divergence_monitor`: see `continuation.ends.divergence`. `last_failed_landing`,
    `last_failed_endgame`: lam at the attempt, or inf. `index`: of the last step. `signs`: of the switches on the piece
    ahead. `noise`: of each equation, shape (N,), or (0,). `tolerance`: relative, raised for noise.
    """

    history: tuple[Knot, ...]
    weights: Array
    anchor: tuple[Array, Array]
    orientation: int
    h: float
    controller: tuple[float, ...]
    monitors: tuple[float, ...]
    occurrences: tuple[int, ...]
    origin: Knot
    origin_weights: Array
    divergence_monitor: tuple[float, ...] = ()
    last_failed_landing: float = float("inf")
    last_failed_endgame: float = float("inf")
    index: int = 0
    signs: tuple[int, ...] = ()
    noise: Array = field(factory=lambda: np.zeros(0))
    tolerance: float = 0.0

    @property
    def here(self) -> Knot:
        """The current point."""
        return self.history[-1]
