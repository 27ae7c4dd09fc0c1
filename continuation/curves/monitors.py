"""Conditions given as functions."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.curves.calculus import Calculus
from continuation.curves.here import Here
from continuation.curves.local import Tangential
from continuation.evaluation.products import by_differences
from continuation.events import Monitor, TargetValue


@frozen(eq=False)
class Vanishing:
    """A function of (y, lam, mu) vanishes: a target value, a switch, or a monitor."""

    calculus: Calculus
    tangential: Tangential
    function: Callable[[Any], Any]
    gradient: Callable[[Array], Array]
    beside: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def at_start(cls, calculus: Calculus, function: Callable[[Any], Any]) -> Vanishing:
        """Try a gradient at the start."""
        return cls(calculus, Tangential.at_start(calculus), function, gradient_of(function, calculus.u0))

    def at(self, u: Array, beside: float, mu: float) -> Here:
        """The condition at a point."""
        x = np.append(u, mu)
        values, none = np.array([float(self.function(x))]), np.empty((u.size - 1, 0))
        return Here(
            self.calculus, u, mu, values, lambda: self.gradient(x)[None, :],
            lambda: self.tangential.factored(u, mu), none,
        )  # fmt: skip


def of_point(event: Any, u: Array) -> Callable[[Any], Any]:
    """The event's function of (y, lam, mu), which also takes jets and intervals; `ValueError` without one."""
    if isinstance(event, TargetValue):
        place = event.component % u.size
        return lambda U: U[place] - event.value
    unknown = np.full(u.size, np.nan)
    if not np.isfinite(event.monitor(u, unknown)):
        raise ValueError(f"event: expected a function of the point alone, found one that takes the tangent: {event!r}")
    function = event.function if isinstance(event, Monitor) else event.monitor
    return lambda U: function(U[:-1], unknown)


def gradient_of(function: Callable[[Any], Any], x0: Array) -> Callable[[Array], Array]:
    """The gradient by jets or differences."""
    from continuation import jets

    def at(x: Array, last: float) -> Array:
        return np.array([function(np.append(x, last))], dtype=float)

    with suppress(TypeError, ArithmeticError, ValueError, AttributeError):
        if jets.jacobian(function, x0).shape == x0.shape:
            return lambda x: jets.jacobian(function, x)
    plain = by_differences(at, x0)
    return lambda x: plain.whole(at, x)[0]
