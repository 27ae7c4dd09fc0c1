"""Conditions that are functions of the caller's: of a point, or of a point and the tangent there."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.curves.calculus import Calculus
from continuation.curves.here import Here
from continuation.curves.local import Scaled, Tangential, last_column
from continuation.evaluation.products import by_differences
from continuation.events import Monitor, TargetValue, TurningPoint
from continuation.events.singularity import full_derivative
from continuation.linear.nullspace import Bordered


@frozen(eq=False)
class Vanishing:
    """A function of (y, lam), and of mu, vanishes: a target value, a switch, a monitor of the caller's.

    `function`: Of (y, lam, mu) as one vector, or jet. `gradient`: Of the vector.
    """

    tangential: Tangential
    function: Callable[[Any], Any]
    gradient: Callable[[Array], Array]
    beside: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def at_start(cls, calculus: Calculus, function: Callable[[Any], Any]) -> Vanishing:
        """With a gradient that is right at the start."""
        return cls(Tangential.at_start(calculus), function, gradient_of(function, calculus.u0))

    def at(self, u: Array, beside: float, mu: float) -> Here:
        """The condition at a point."""
        U, one = np.append(u, mu), np.empty((u.size - 1, 0))
        values, gradients = np.array([float(self.function(U))]), lambda: self.gradient(U)[None, :]
        return Here(self.tangential.calculus, u, mu, values, gradients, lambda: self.tangential.factored(u, mu)[0], one)


@frozen(eq=False)
class AlongTangent:
    """A function of (y, lam) and of the tangent there vanishes: where an unknown turns, say.

    The tangent's derivative comes from M dt = -H''[t, .], M = [H_y, H_lam] with a border, by one solve with M'.

    `function`: Of u and v as one vector. `gradient`: Of the vector.
    """

    scaled: Scaled
    tangential: Tangential
    function: Callable[[Array], float]
    gradient: Callable[[Array], Array]
    beside: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def at_start(cls, calculus: Calculus, function: Callable[[Any], Any]) -> AlongTangent:
        """With a gradient that is right at the start."""
        tangential, u, mu = Tangential.at_start(calculus), calculus.u0[:-1], float(calculus.u0[-1])
        gradient = gradient_of(function, np.append(u, tangential.factored(u, mu)[1]))
        return cls(Scaled.at_start(calculus), tangential, function, gradient)

    def null_vector(self, u: Array) -> Array:
        """The tangent of the member's path at a point of the curve, behind which is mu; in the extents of the start."""
        return self.tangential.factored(u[:-1], float(u[-1]))[1] / self.scaled.calculus.extent

    def at(self, u: Array, beside: float, mu: float) -> Here:
        """The condition at a point."""
        calculus, extent, rows = self.scaled.calculus, self.scaled.calculus.extent, self.scaled.rows
        system, t = self.tangential.factored(u, mu)

        def gradients() -> Array:
            by_u, by_t = np.split(self.gradient(np.append(u, t)), 2)
            full, border = full_derivative(calculus.evaluator(mu), u), t / extent
            H_lam = extent[-1] * last_column(full) / rows
            M = Bordered.of(self.scaled.times(full[:, :-1]), H_lam[:, None], border[None])
            left = M.solve(extent * by_t, adjoint=True)[:-1] / rows
            return np.asarray(np.append(by_u, 0.0) - calculus.second(u, mu, t, left))[None, :]

        values = np.array([self.function(np.append(u, t))])
        return Here(calculus, u, mu, values, gradients, lambda: system, np.empty((rows.size, 0)))


def without_tangent(event: Any, u: Array) -> Callable[[Any], Any] | None:
    """What vanishes at an event, of (y, lam, mu) as one vector or jet; None where it looks at the tangent too.

    `u`, of shape (N + 1,): A point to try it at.
    """
    if isinstance(event, TargetValue):
        place = event.component % u.size
        return lambda U: U[place] - event.value
    unknown = np.full(u.size, np.nan)
    if not np.isfinite(event.monitor(u, unknown)):
        return None
    return lambda U: plainly(event)(U[:-1], unknown)


def plainly(event: Any) -> Callable[[Any, Any], Any]:
    """The function of u and v that an event's monitor makes a float of: of jets and intervals, too."""
    if isinstance(event, TurningPoint):
        return lambda u, v: v[event.component]
    return event.function if isinstance(event, Monitor) else event.monitor


def gradient_of(function: Callable[[Any], Any], x0: Array) -> Callable[[Array], Array]:
    """The gradient of a function of a vector, by jets, or by differences where it does not run on jets at x0."""
    from continuation import jets

    def at(x: Array, last: float) -> Array:
        return np.array([function(np.append(x, last))], dtype=float)

    with suppress(TypeError, ArithmeticError, ValueError, AttributeError):
        if jets.jacobian(function, x0).shape == x0.shape:
            return lambda x: jets.jacobian(function, x)
    plain = by_differences(at, x0)
    return lambda x: plain.whole(at, x)[0]
