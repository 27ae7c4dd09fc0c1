"""What a predictor is."""

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
    """A past point of the path: what a predictor may remember."""

    arclength: float
    u: Array
    tangent: Array


class Prediction(Protocol):
    """A curve that starts at the current point; made once a point, asked once an attempt."""

    @property
    def reach(self) -> float:
        """The longest step for which the prediction is trusted; inf where the predictor cannot tell."""
        ...

    def __call__(self, h: float) -> Array:
        """The predicted point at step length h > 0, shape (N + 1,)."""
        ...


@runtime_checkable
class SupportsSegment(Curve, Protocol):
    """A prediction accurate enough to be the path between its ends: dense output, and where events are looked for."""

    def segment(self, h: float, end: Array) -> Segment:
        """The path from the current point to the corrected one, `end`, at step length h.

        Parameters
        ----------
        h : float
        end : ndarray, shape (N + 1,)
        """
        ...


class Predictor(Protocol):
    """A way to predict the next point.

    Attributes
    ----------
    memory : int
        How many past knots it uses, the current one included.
    order : int
        The local error is O(h^(order + 1)); where it depends on the problem, the least, and the prediction's own
        `order` is the one that holds.
    interior_fraction : float, optional
        How much of the way to the boundary of its domain a prediction may go; 0.9 where the predictor does not say.
    """

    @property
    def memory(self) -> int:
        """Knots used."""
        ...

    @property
    def order(self) -> int:
        """Order of accuracy."""
        ...

    def prepare(self, evaluator: Evaluator, point: Linearization, history: Sequence[Knot]) -> Prediction:
        """The prediction from `point`; `history` holds at most `memory` knots, the current one last.

        Parameters
        ----------
        evaluator : Evaluator
            Of the homotopy; it counts what is asked.
        point : Linearization
            The current point, with its factorisation and tangent.
        history : sequence of Knot
        """
        ...


def history_in_pseudo_arclength(point: Linearization, history: Sequence[Knot]) -> list[tuple[float, Array, Array]]:
    """The history in the pseudo-arclength of the current point, newest first: (sigma, u, du/dsigma).

    sigma = border . (u - point.u) measures all knots alike, though each was reached in a metric of its own. Knots from
    where the path had turned through a right angle, or from where sigma does not fall, are left out with all before
    them.
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
