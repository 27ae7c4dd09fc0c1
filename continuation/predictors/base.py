"""Protocols of predictors and predictions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from attrs import frozen

from continuation.arrays import Array
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import Linearization


@frozen(eq=False)
class Knot:
    """A past point of the path."""

    arclength: float
    u: Array
    tangent: Array


class Prediction(Protocol):
    """A curve from the current point.

    With a `derivative` and an `order`, it is accurate enough to be the path (`continuation.point.segment.Curve`).
    """

    @property
    def reach(self) -> float:
        """Longest trusted step; inf if unknown."""
        ...

    def __call__(self, h: float) -> Array:
        """The point at step length h > 0, shape (N + 1,)."""
        ...


class Predictor(Protocol):
    """Predicts the next point.

    Attributes
    ----------
    memory : int
        Number of knots used, the current one included.
    order : int
        Local error O(h^(order + 1)); the least, if predictions have an `order`.
    interior_fraction : float, optional
        Usable part of the distance to the boundary; default 0.9.
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
        """The prediction from `point`.

        Parameters
        ----------
        evaluator : Evaluator
        point : Linearization
            Current point, with factorisation and tangent.
        history : sequence of Knot
            At most `memory` knots, the current one last.
        """
        ...
