"""The state of a trace between steps."""

from __future__ import annotations

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.predictors import Knot


@frozen(eq=False)
class State:
    """State at an accepted point; with the settings it determines the rest of the path.

    Attributes
    ----------
    history : tuple of Knot
        The predictor's knots, the current point last.
    weights : ndarray, shape (N + 1,)
        Metric.
    anchor : tuple of two ndarrays, shape (N + 1,)
        Point and border of the factorisation.
    orientation : int
        Determinant sign of the tangent.
    h : float
        Next step length.
    controller : tuple of float
    monitors : tuple of float
        Values of the events; 0 if found at the point.
    occurrences : tuple of int
        Counts of the events.
    origin : Knot
        The start, with metric `origin_weights`.
    divergence_monitor : tuple of float
        See `continuation.ends.divergence`.
    last_failed_landing : float
        Parameter value, or inf.
    last_failed_endgame : float
        Parameter value, or inf.
    index : int
        The last step's.
    signs : tuple of int
        The piece ahead.
    noise : ndarray, shape (N,), or (0,) where there is none
        Each equation's.
    tolerance : float
        Raised for noise, else 0.
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
