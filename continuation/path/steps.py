"""Steps and events."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import field, frozen

from continuation.arrays import Array
from continuation.point.segment import Segment
from continuation.rejection import Rejected
from continuation.status import Kind


def _one_line(name: str, point: Any) -> str:
    shown = ", ".join(f"{value:.6g}" for value in point.y[:3])
    more = ", ..." if point.y.size > 3 else ""
    return f"<{name}: arclength {point.arclength:.6g}, lam = {point.lam:.6g}, y = ({shown}{more})>"


class Located:
    """A point `u` = (y, lam) of a path."""

    __slots__ = ()

    u: Array

    @property
    def y(self) -> Array:
        """The unknowns, shape (N,)."""
        return self.u[:-1]

    @property
    def lam(self) -> float:
        """The parameter."""
        return float(self.u[-1])


@frozen(eq=False, repr=False)
class Step(Located):
    """One accepted point.

    Attributes
    ----------
    index : int
    u, tangent : ndarray, shape (N + 1,)
    arclength : float
        Sum of circular arcs through two points with the angle between their tangents, in the step's metric: the curve's
        length to fourth order in the angle.
    step_length : float
        The predictor's step; 0 at the start.
    residual_norm : float
        Largest component of the residual.
    orientation : int
        Sign of det [[H'], [tangent']].
    kind : Kind
    corrector_iterations, rejections : int
        Iterations, and attempts before.
    contraction, distance, angle, share : float
        First ratio of increments; length of the correction; angle (radians) between tangents; the parameter's share of
        the tangent.
    segment : Segment or None
        The path from the point before.
    weights : ndarray or None
        The metric.
    rejected : tuple of Rejected
        Attempts before. Not archived.
    observed : mapping
        Extra scalars of the homotopy.
    """

    index: int
    u: Array
    tangent: Array
    arclength: float
    step_length: float = 0.0
    residual_norm: float = 0.0
    orientation: int = 0
    kind: Kind = field(default=Kind.REGULAR, converter=Kind)
    corrector_iterations: int = 0
    rejections: int = 0
    contraction: float = 0.0
    distance: float = 0.0
    angle: float = 0.0
    share: float = 0.0
    segment: Segment | None = None
    weights: Array | None = None
    rejected: tuple[Rejected, ...] = ()
    observed: Mapping[str, float] = field(factory=dict)

    def __repr__(self) -> str:
        return _one_line(f"Step {self.index}, {self.kind.flag.replace('_', ' ')}", self)


@frozen(eq=False, repr=False)
class LocatedEvent(Located):
    """A point of the path at which a monitor vanishes.

    Attributes
    ----------
    name : str
    kind : Kind
    arclength : float
    u, tangent : ndarray, shape (N + 1,)
    residual_norm : float
    monitor : float
        The monitor's value.
    orientation : int
        As in `Step`.
    step : int
        The event lies between steps step - 1 and step.
    ends_step : bool
        Whether it is that step's point.
    switches : tuple of int
        At a kink: the vanishing switching functions.
    rays : ndarray, shape (k, N + 1), or None
        At a kink or simple branch point: unit directions of all branches away from it; first back along the path, then
        onward. Archives keep those of kinks.
    weights : ndarray, shape (N + 1,), or None
        The metric; None after reading.
    observed : mapping
        Extra scalars.
    """

    name: str
    kind: Kind = field(converter=Kind)
    arclength: float
    u: Array
    tangent: Array
    residual_norm: float
    monitor: float
    orientation: int
    step: int
    ends_step: bool = False
    switches: tuple[int, ...] = ()
    rays: Array | None = None
    weights: Array | None = None
    observed: Mapping[str, float] = field(factory=dict)

    def __repr__(self) -> str:
        return _one_line(f"LocatedEvent {self.name}", self)

    @property
    def turns(self) -> bool:
        """Whether the parameter turns."""
        return self.kind is Kind.TURNING_POINT and self.name == "turning point"
