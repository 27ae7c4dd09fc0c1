"""The interface of events, and common ones."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE, complain, integer, of_kind, sign
from continuation.arrays import Array
from continuation.status import Kind


class Event(Protocol):
    """A monitor function and what its zeros do.

    Attributes
    ----------
    name : str
    kind : int
        One of `continuation.Kind`.
    terminal : int
        The occurrence that ends the trace; 0: none.
    direction : int
        +1: rising zeros only; -1: falling only; 0: both.
    """

    @property
    def name(self) -> str:
        """Name in path and archive."""
        ...

    @property
    def kind(self) -> int:
        """Kind."""
        ...

    @property
    def terminal(self) -> int:
        """Occurrence that ends the trace."""
        ...

    @property
    def direction(self) -> int:
        """Crossings that count."""
        ...

    def monitor(self, u: Array, v: Array) -> float:
        """A function of point and tangent, continuous along the path.

        Parameters
        ----------
        u : ndarray, shape (N + 1,)
            A point (y, lam).
        v : ndarray, shape (N + 1,)
            Unit tangent.
        """
        ...


@frozen
class TurningPoint:
    """A component of the tangent changes sign: the parameter's by default (a fold)."""

    component: int = field(default=-1, validator=integer())
    terminal: int = field(default=0, validator=integer(0))
    direction: int = field(default=0, validator=sign)
    kind: Kind = field(default=Kind.TURNING_POINT, init=False)

    @property
    def name(self) -> str:
        """``turning point``, with the component unless it is the parameter."""
        return "turning point" if self.component == -1 else f"turning point of component {self.component}"

    def monitor(self, u: Array, v: Array) -> float:
        """The tangent's component."""
        return float(v[self.component])

    def resolution(self, noise: Array, length: float) -> float:
        """Tangent component that moves a point by its round-off over the arc.

        Parameters
        ----------
        noise : ndarray, shape (N + 1,)
            Round-off of a point.
        length : float
            Of the arc.
        """
        return float(noise[self.component]) / length


@frozen
class TargetValue:
    """The parameter (component -1) or a component of y takes a value, exactly."""

    value: float = field(validator=FINITE)
    component: int = field(default=-1, validator=integer())
    terminal: int = field(default=1, validator=integer(0))
    direction: int = field(default=0, validator=sign)
    kind: Kind = field(default=Kind.EVENT, init=False)

    @property
    def name(self) -> str:
        """Condition as text."""
        what = "lam" if self.component == -1 else f"component {self.component}"
        return f"{what} = {self.value:g}"

    def monitor(self, u: Array, v: Array) -> float:
        """The component minus the value."""
        return float(u[self.component]) - self.value


@frozen
class KinkPoint:
    """A switching function vanishes; the path continues on another piece.

    The tracer always watches for it; list it to stop there.
    """

    terminal: int = field(default=1, validator=integer(0))
    direction: int = field(default=0, init=False)
    kind: Kind = field(default=Kind.KINK, init=False)
    name: str = field(default="kink", init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """A constant, since the tracer watches."""
        return 1.0


@frozen
class Monitor:
    """A function of the point u and the unit tangent v vanishes."""

    function: Callable[[Array, Array], float] = field(validator=of_kind("a function of u and v", callable))
    name: str = field(default="event", validator=of_kind("a text", lambda value: isinstance(value, str)))
    terminal: int = field(default=0, validator=integer(0))
    direction: int = field(default=0, validator=sign)
    kind: Kind = field(default=Kind.EVENT, init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """The function's value."""
        found: Any = self.function(u, v)
        if isinstance(found, float):
            return found
        if np.ndim(found) or np.asarray(found).dtype.kind not in "fiub":
            raise complain(TypeError, "function", "a real number", found)
        return float(found)
