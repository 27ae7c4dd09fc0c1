"""Protocols of predictors and predictions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from attrs import frozen

from continuation.arrays import Array, dot
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import Linearization
from continuation.point.segment import Curve, Segment


@frozen(eq=False)
class Knot:
    """A past point of the path."""

    arclength: float
    u: Array
    tangent: Array


class Prediction(Protocol):
    """A curve from the current point; made once a point, called once an attempt."""

    @property
    def reach(self) -> float:
        """Longest trusted step; inf if unknown."""
        ...

    def __call__(self, h: float) -> Array:
        """Return the point at step length h > 0, shape (N + 1,)."""
        ...


@runtime_checkable
class SupportsSegment(Curve, Protocol):
    """A prediction accurate enough to be the path between its ends."""

    def segment(self, h: float, end: Array) -> Segment:
        """Return the path from the current to the corrected point.

        Parameters
        ----------
        h : float
        end : ndarray, shape (N + 1,)
            Corrected point.
        """
        ...


class Predictor(Protocol):
    """Predicts the next point.

    Attributes
    ----------
    memory : int
        Number of knots used, with the current one.
    order : int
        Local error O(h^(order + 1)); the least, if the prediction has its own `order`.
    interior_fraction : float, optional
        Part of the distance to the boundary that it may use; default 0.9.
    """

    @property
    def memory(self) -> int:
        """Number of knots used."""
        ...

    @property
    def order(self) -> int:
        """Order of accuracy."""
        ...

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Prediction:
        """Return the prediction from `point`.

        Parameters
        ----------
        evaluator : Evaluator
        point : Linearization
            Current point, with factorisation and tangent.
        history : sequence of Knot
            At most `memory` knots, the current one last.
        """
        ...


def history_in_pseudo_arclength(point: Linearization, history: Sequence[Knot]) -> list[tuple[float, Array, Array]]:
    """Return the history, newest first: (sigma, u, du/dsigma), sigma = border . (u - point.u).

    Knots before a right-angle turn, or where sigma stops decreasing, are dropped.
    """
    border = point.border
    knots = [(0.0, point.u, point.tangent)]
    for knot in reversed(history[:-1]):
        sigma = dot(border, knot.u - point.u)
        along = dot(border, knot.tangent)
        if not (sigma < knots[-1][0] and along > 0.0):
            break
        knots.append((sigma, knot.u, knot.tangent / along))
    return knots
