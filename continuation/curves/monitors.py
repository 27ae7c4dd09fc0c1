"""Conditions given as functions."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.curves.calculus import Calculus
from continuation.curves.here import CurvePoint
from continuation.curves.local import Tangential, last_column
from continuation.evaluation.products import by_differences
from continuation.events import Monitor, TargetValue, TurningPoint
from continuation.events.singularity import full_derivative
from continuation.linear.nullspace import Bordered


@frozen(eq=False)
class Vanishing:
    """A function vanishes: a target value, a switch, or a monitor.

    It takes (y, lam, mu), or (y, lam, tangent) if `along`. With M = [H_y, H_lam] bordered, the tangent t has M dt =
    -H''[t, .], so one solve with M' gives the derivative.
    """

    calculus: Calculus
    tangential: Tangential
    function: Callable[[Any], Any]
    gradient: Callable[[Array], Array]
    along: bool
    beside: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def at_start(cls, calculus: Calculus, function: Callable[[Any], Any], along: bool) -> Vanishing:
        """Try a gradient at the start."""
        tangential, x = Tangential.at_start(calculus), calculus.u0
        if along:
            x = np.append(x[:-1], tangential.factored(x[:-1], float(x[-1]))[1])
        return cls(calculus, tangential, function, gradient_of(function, x), along)

    def null_vector(self, u: Array) -> Array:
        """The member's tangent, in extents."""
        return self.tangential.factored(u[:-1], float(u[-1]))[1] / self.calculus.extent

    def at(self, u: Array, beside: float, mu: float) -> CurvePoint:
        """The condition at a point."""
        calculus, extent = self.calculus, self.calculus.extent
        kernel = cache(lambda: self.tangential.factored(u, mu))
        x = np.append(u, kernel()[1] if self.along else mu)

        def gradients() -> Array:
            if not self.along:
                return self.gradient(x)[None, :]
            by_u, by_t = np.split(self.gradient(x), 2)
            full, t, rows = full_derivative(calculus.evaluator(mu), u), kernel()[1], calculus.rows
            H_lam = extent[-1] * last_column(full) / rows
            M = Bordered.of(calculus.scaled(full[:, :-1]), H_lam[:, None], (t / extent)[None])
            left = M.solve(extent * by_t, adjoint=True)[:-1] / rows
            return np.asarray(np.append(by_u, 0.0) - calculus.second(u, mu, t, left))[None, :]

        values = np.array([float(self.function(x))])
        return CurvePoint(calculus, u, mu, values, gradients, lambda: kernel()[0], np.empty((u.size - 1, 0)))


def without_tangent(event: Any, u: Array) -> Callable[[Any], Any] | None:
    """The event's function of (y, lam, mu); None if it needs the tangent."""
    if isinstance(event, TargetValue):
        place = event.component % u.size
        return lambda U: U[place] - event.value
    unknown = np.full(u.size, np.nan)
    if not np.isfinite(event.monitor(u, unknown)):
        return None
    return lambda U: plainly(event)(U[:-1], unknown)


def plainly(event: Any) -> Callable[[Any, Any], Any]:
    """A monitor's function, which also takes jets and intervals."""
    if isinstance(event, TurningPoint):
        return lambda u, v: v[event.component]
    return event.function if isinstance(event, Monitor) else event.monitor


def gradient_of(function: Callable[[Any], Any], x0: Array) -> Callable[[Array], Array]:
    """Gradient by jets or differences."""
    from continuation import jets

    def at(x: Array, last: float) -> Array:
        return np.array([function(np.append(x, last))], dtype=float)

    with suppress(TypeError, ArithmeticError, ValueError, AttributeError):
        if jets.jacobian(function, x0).shape == x0.shape:
            return lambda x: jets.jacobian(function, x)
    plain = by_differences(at, x0)
    return lambda x: plain.whole(at, x)[0]
