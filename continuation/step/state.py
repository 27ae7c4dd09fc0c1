"""The state that a trace carries from step to step: arrays and numbers, so that an archive can store it."""

from __future__ import annotations

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.predictors import Knot


@frozen(eq=False)
class State:
    """The state at an accepted point; with the settings it determines the rest of the path, bit for bit.

    Attributes
    ----------
    history : tuple of Knot
        The current point last, after as many points as the predictor remembers.
    weights : ndarray, shape (N + 1,)
        Metric at the point.
    anchor : tuple of two ndarrays, shape (N + 1,)
        Point and border of the current factorisation.
    orientation : int
        Determinant sign that the tangent must have.
    h : float
        Step length to try next.
    controller : tuple of float
        State of the controller.
    monitors : tuple of float
        Monitor values of the events at the point; 0 if an event was found there.
    occurrences : tuple of int
        Number of locations of each event so far.
    origin : Knot
        The start, and `origin_weights` its metric: to recognise a closed curve.
    divergence_monitor : tuple of float
        See `continuation.ends.divergence`.
    last_failed_landing : float
        Parameter value of the last failed landing; inf if none.
    last_failed_endgame : float
        Parameter value of the last failed endgame; inf if none.
    index : int
        Index of the step that led here.
    signs : tuple of int
        The piece on which the path continues, if the homotopy has pieces.
    noise : ndarray, shape (N,), or (0,) where there is none
        Measured noise of each equation, if larger than round-off of the point.
    tolerance : float
        Relative tolerance raised for noise; 0 if not raised.
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
