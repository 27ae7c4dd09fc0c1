"""Everything a trace carries from one step to the next, as arrays and numbers that an archive can hold."""

from __future__ import annotations

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.predictors import Knot


@frozen(eq=False)
class State:
    """The stepper's state at an accepted point; with the settings it determines the rest of the path, bit for bit.

    Attributes
    ----------
    history : tuple of Knot
        The current point last, with as many before it as the predictor remembers.
    weights : ndarray, shape (N + 1,)
        The metric at the point.
    anchor : tuple of two ndarrays, shape (N + 1,)
        Where the factorisation at hand was made, and with which border.
    orientation : int
        The determinant sign that the tangent is to have.
    h : float
        The step length to try next.
    controller : tuple of float
        The controller's state.
    monitors : tuple of float
        Values of the events' monitors at the point; 0 where an event was found on it.
    occurrences : tuple of int
        How often each event has been located.
    origin : Knot
        The start, and `origin_weights` the metric there: for recognising a closed curve.
    divergence_monitor : tuple of float
        For recognising divergence: see `continuation.ends.divergence`.
    last_failed_landing : float
        The parameter value at which landing was last tried in vain; inf if never.
    last_failed_endgame : float
        The parameter value at which the endgame was last tried in vain; inf if never.
    index : int
        Of the step that led here.
    signs : tuple of int
        The piece on which the path goes on, where the homotopy has pieces.
    noise : ndarray, shape (N,), or (0,) where there is none
        What each equation was seen to be uncertain by at the start, where that is more than round-off of the point.
    tolerance : float
        The relative tolerance that noise allows; 0 where it was not raised.
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
