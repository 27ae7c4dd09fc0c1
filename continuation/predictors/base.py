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
    """A prediction so accurate that it serves as the path between its ends."""

    def segment(self, h: float, end: Array) -> Segment:
        """Return the path from the current point to the corrected point.

        Parameters
        ----------
        h : float
            Step length.
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
        The local error is O(h^(order + 1)); if it varies, the least, and the prediction has its own `order`.
    interior_fraction : float, optional
        Largest part of the distance to the boundary that a prediction may use; default 0.9.
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
            Counted evaluations of the homotopy.
        point : Linearization
            Current point, with factorisation and tangent.
        history : sequence of Knot
            At most `memory` knots, the current one last.
        """
        ...


def history_in_pseudo_arclength(point: Linearization, history: Sequence[Knot]) -> list[tuple[float, Array, Array]]:
    """Return the history in the pseudo-arclength of the current point, newest first: (sigma, u, du/dsigma).

    sigma = border . (u - point.u) uses one metric for all knots. Knots before a turn by a right angle, or where sigma
    does not decrease, are dropped with all earlier ones.
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
