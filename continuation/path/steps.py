"""The points of a path: accepted steps, and events located between them."""

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


@frozen(eq=False, repr=False)
class Step:
    """One accepted point of the path and how it was reached.

    Attributes
    ----------
    index : int
        0 at the start.
    u, tangent : ndarray, shape (N + 1,)
    arclength : float
        The parameter of the path: the sum of the lengths of its steps, each that of the circular arc through its two
        points with the angle between their tangents, in the metric of that step. A length of the curve to a relative
        error of the fourth order in the angle (`continuation.arclength` measures it to 1e-9); traces whose steps end
        elsewhere, if only by round-off, differ in it.
    step_length : float
        The predictor's step that led here; 0 at the start.
    residual_norm : float
        Largest component of the residual, evaluated at u.
    orientation : int
        Sign of det [[H'], [tangent']].
    kind : Kind
    corrector_iterations, rejections : int
        Of the accepted attempt, and the attempts before it.
    contraction, distance, angle, share : float
        First ratio of the corrector's increments; length of its correction; angle (radians) between the tangents; the
        parameter's share of the tangent.
    segment : Segment or None
        The path from the point before to this one.
    weights : ndarray or None
        The metric in which that was measured.
    rejected : tuple of Rejected
        The attempts before the accepted one: step length, contraction and reason. Not kept in archives.
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

    @property
    def y(self) -> Array:
        """The unknowns, shape (N,)."""
        return self.u[:-1]

    @property
    def lam(self) -> float:
        """The parameter."""
        return float(self.u[-1])


@frozen(eq=False, repr=False)
class LocatedEvent:
    """A point of the path at which a monitor vanishes, corrected onto the path and polished.

    Attributes
    ----------
    name : str
    kind : Kind
    arclength : float
    u, tangent : ndarray, shape (N + 1,)
    residual_norm : float
        Of H at u.
    monitor : float
        The monitor's value at u: how well the event is located.
    orientation : int
    step : int
        Index of the step in which it lies (from step - 1 to step).
    ends_step : bool
        Whether it is that step's own point.
    switches : tuple of int
        At a kink: the switching functions that vanish there.
    rays : ndarray, shape (k, N + 1), or None
        At a kink or a simple branch point: the directions of all branches that meet there, of unit length in the
        metric, each pointing away from it. The first leads back to where the path came from, the second, if any, is
        the one the path goes on in. Files keep those of kinks.
    weights : ndarray, shape (N + 1,), or None
        The metric there; None for an event read from a file.
    observed : mapping
        Extra scalars of the homotopy, at u.
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
    def y(self) -> Array:
        """The unknowns, shape (N,)."""
        return self.u[:-1]

    @property
    def turns(self) -> bool:
        """Whether it is a turning point of the parameter: of another number's, as of a curve's, it has another name."""
        return self.kind is Kind.TURNING_POINT and self.name == "turning point"

    @property
    def lam(self) -> float:
        """The parameter."""
        return float(self.u[-1])
