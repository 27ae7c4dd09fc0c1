"""A puck that slides on a plane in any direction: the cone of friction as a pyramid."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE, integer
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import arrow
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Puck:
    """A puck on a rough plane that moves in three dimensions: how does friction bend and slow its motion?

    Coulomb's cone is replaced by a pyramid. The force against the motion is too small by a factor of cos(pi / edges) at
    worst, second order in 1 / edges; what it has across the motion is first order, and bends it.

    Parameters
    ----------
    mass : float
        kg.
    friction : float
    speed : float
        m/s, before the step.
    heading : float
        Degrees, against the pyramid's first edge.
    edges : int
        Of the pyramid.
    gravity : float
        m/s^2.
    step : float
        s.

    References
    ----------
    Stewart and Trinkle, Int. J. Numer. Methods Eng. 39 (1996).
    """

    mass: float = positive(1.0)
    friction: float = positive(0.5)
    speed: float = positive(1.0)
    heading: float = field(default=20.0, validator=FINITE)
    edges: int = field(default=8, validator=integer(3))
    gravity: float = positive(9.81)
    step: float = positive(0.01)
    units: ClassVar[Units] = {"speed": "m/s", "heading": "degrees", "friction against motion": "N s"}
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The direction of friction is not known before, so every edge of the pyramid may be needed."""
        return (
            Unknown("normal impulse", 1, "the limit of friction"),
            Unknown("impulses along edges", self.edges, "friction in any direction"),
            Unknown("slip velocity", 1, "whether friction is at its limit"),
        )

    @property
    def _edges(self) -> Array:
        angle = 2.0 * np.pi * np.arange(self.edges) / self.edges
        return np.stack([np.cos(angle), np.sin(angle)])

    @property
    def _before(self) -> Array:
        angle = np.deg2rad(self.heading)
        return self.speed * np.array([np.cos(angle), np.sin(angle)])

    def problem(self) -> LCP:
        """One time step."""
        D, k = self._edges, self.edges
        A = np.zeros((k + 2, k + 2))
        A[0, 0], A[1:-1, 1:-1] = 1.0 / self.mass, D.T @ D / self.mass
        A[1:-1, -1], A[-1, 0], A[-1, 1:-1] = 1.0, self.friction, -1.0
        return LCP(A, np.concatenate([[-self.step * self.gravity], D.T @ self._before, [0.0]]))

    def answer(self, solution: Any) -> Quantities:
        """Velocity after the step, and the impulse of friction against that before."""
        along = self._edges @ solution.x[1:-1]
        after = self._before + along / self.mass
        return {
            "speed": float(np.hypot(*after)), "heading": float(np.rad2deg(np.arctan2(after[1], after[0]))),
            "friction against motion": float(-along @ self._before) / self.speed,
        }  # fmt: skip

    def exact(self) -> Quantities:
        """With the round cone, while it slides: friction is opposite to the motion."""
        loss = self.friction * self.gravity * self.step
        if loss >= self.speed:
            return {"speed": 0.0, "friction against motion": self.mass * self.speed}
        heading = (self.heading + 180.0) % 360.0 - 180.0
        return {"speed": self.speed - loss, "heading": heading, "friction against motion": self.mass * loss}

    def draw(self, solution: Any, axes: Any) -> None:
        """The pyramid's section, the impulse of friction in it, and the direction of the motion."""
        limit = self.friction * self.mass * self.gravity * self.step
        corners = limit * np.column_stack([self._edges, self._edges[:, 0]])
        angle = np.linspace(0.0, 2.0 * np.pi, 200)
        axes.plot(limit * np.cos(angle), limit * np.sin(angle), color="0.7", label="cone")
        axes.plot(*corners, color="#0072B2", label="pyramid")
        arrow(axes, (0.0, 0.0), tuple(self._edges @ solution.x[1:-1]), 1, "friction")
        arrow(axes, (0.0, 0.0), tuple(limit * self._before / self.speed), 2, "direction of the motion")
        axes.set(aspect="equal", xlabel="impulse (N s)", ylabel="impulse (N s)")
        axes.legend(fontsize="small", frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
