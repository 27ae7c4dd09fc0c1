"""Events: functions along the path whose zeros are located on corrected points, never interpolated."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE, complain, integer, of_kind, sign
from continuation.arrays import Array
from continuation.status import Kind


class Event(Protocol):
    """A monitor, and what to do where it vanishes.

    Attributes
    ----------
    name : str
    kind : int
        One of `continuation.Kind`, stored with the point.
    terminal : int
        The trace ends at the k-th occurrence; 0 for never.
    direction : int
        +1 only where the monitor rises, -1 only where it falls, 0 both.
    """

    @property
    def name(self) -> str:
        """What it is called in the path and the archive."""
        ...

    @property
    def kind(self) -> int:
        """Kind of the located point."""
        ...

    @property
    def terminal(self) -> int:
        """At which occurrence the trace ends."""
        ...

    @property
    def direction(self) -> int:
        """Which crossings count."""
        ...

    def monitor(self, u: Array, v: Array) -> float:
        """The function whose zeros are wanted, of the point and the tangent; continuous along the path.

        Parameters
        ----------
        u : ndarray, shape (N + 1,)
            A point (y, lam) of the path.
        v : ndarray, shape (N + 1,)
            The unit tangent there.

        Returns
        -------
        float
        """
        ...


@frozen
class TurningPoint:
    """Where a component of the tangent changes sign: the parameter by default (a fold), or a component of y."""

    component: int = field(default=-1, validator=integer())
    terminal: int = field(default=0, validator=integer(0))
    direction: int = field(default=0, validator=sign)
    kind: Kind = field(default=Kind.TURNING_POINT, init=False)

    @property
    def name(self) -> str:
        """``turning point``, with the component where it is not the parameter."""
        return "turning point" if self.component == -1 else f"turning point of component {self.component}"

    def monitor(self, u: Array, v: Array) -> float:
        """The tangent's component."""
        return float(v[self.component])

    def resolution(self, noise: Array, length: float) -> float:
        """The tangent's component that moves the point by no more than its round-off over the arc.

        Parameters
        ----------
        noise : ndarray, shape (N + 1,)
            How far round-off moves each component of a point.
        length : float
            Of the arc, in the units of the tangent.
        """
        return float(noise[self.component]) / length


@frozen
class TargetValue:
    """Where the parameter (component -1), or a component of y, takes a value; the point lands on it exactly."""

    value: float = field(validator=FINITE)
    component: int = field(default=-1, validator=integer())
    terminal: int = field(default=1, validator=integer(0))
    direction: int = field(default=0, validator=sign)
    kind: Kind = field(default=Kind.EVENT, init=False)

    @property
    def name(self) -> str:
        """The condition as text."""
        what = "lam" if self.component == -1 else f"component {self.component}"
        return f"{what} = {self.value:g}"

    def monitor(self, u: Array, v: Array) -> float:
        """The component minus the value."""
        return float(u[self.component]) - self.value


@frozen
class KinkPoint:
    """Where a switching function of a piecewise smooth homotopy vanishes, and the path goes on on another piece.

    The tracer always watches for it; name it among the events to stop at it.
    """

    terminal: int = field(default=1, validator=integer(0))
    direction: int = field(default=0, init=False)
    kind: Kind = field(default=Kind.KINK, init=False)
    name: str = field(default="kink", init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """A constant: the tracer watches the switches itself."""
        return 1.0


@frozen
class Monitor:
    """Where a function of the caller's, of the point u and the unit tangent v, vanishes."""

    function: Callable[[Array, Array], float] = field(validator=of_kind("a function of u and v", callable))
    name: str = field(default="event", validator=of_kind("a text", lambda value: isinstance(value, str)))
    terminal: int = field(default=0, validator=integer(0))
    direction: int = field(default=0, validator=sign)
    kind: Kind = field(default=Kind.EVENT, init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """The caller's function."""
        found: Any = self.function(u, v)
        if isinstance(found, float):
            return found
        if np.ndim(found) or np.asarray(found).dtype.kind not in "fiub":
            raise complain(TypeError, "function", "a real number", found)
        return float(found)
