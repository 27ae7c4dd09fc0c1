"""A box on two corners, pushed at its top: it rests, slides, or tips."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE, NOT_NEGATIVE
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import arrow, rectangle
from problems.scenes.planar import contact_unknowns, free_motion, impulses, time_step
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Box:
    """A box that stands on a rough floor and is pushed at the height of its top: does it rest, slide, or tip?

    A flat floor bears on the two corners alone: what presses between them can be replaced by forces there.

    Parameters
    ----------
    width, height : float
        m.
    mass : float
        kg.
    friction : float
    push : float
        N, to the right.
    gravity : float
        m/s^2.
    step : float
        s.
    """

    width: float = positive(1.0)
    height: float = positive(2.0)
    mass: float = positive(1.0)
    friction: float = field(default=0.5, validator=NOT_NEGATIVE)
    push: float = field(default=2.0, validator=FINITE)
    gravity: float = positive(9.81)
    step: float = positive(0.01)
    units: ClassVar[Units] = {
        "left force": "N", "right force": "N", "friction force": "N", "speed": "m/s", "rotation": "rad/s",
    }  # fmt: skip
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Four a corner."""
        return contact_unknowns(2)

    def _step(self) -> tuple[Array, Array, Array, Array]:
        """The matrix, J, the inverse masses, and the velocity after the step without a floor."""
        inertia = self.mass * (self.width**2 + self.height**2) / 12.0
        half = 0.5 * self.width
        corners = [(0, -1, side, 0.0, 0.0, 1.0) for side in (-half, half)]
        A, J, inverse = time_step([(self.mass, inertia, 0.0, 0.5 * self.height)], corners, self.friction)
        load = np.array([self.push, -self.mass * self.gravity, -0.5 * self.push * self.height])
        return A, J, inverse, self.step * inverse * load

    def problem(self) -> LCP:
        """One time step from rest."""
        A, J, _, free = self._step()
        return LCP(A, free_motion(J @ free))

    def answer(self, solution: Any) -> Quantities:
        """Forces of the floor, and velocities after the step; to tip is to turn, which is a negative rotation."""
        _, J, inverse, free = self._step()
        p = impulses(solution.x)
        velocity = free + inverse * (J.T @ p)
        left, right = p[::2] / self.step
        return {
            "left force": left, "right force": right, "friction force": float(p[1::2].sum()) / self.step,
            "speed": velocity[0], "rotation": velocity[2],
        }  # fmt: skip

    def exact(self) -> Quantities:
        """Of a box that rests; one that slides, or tips, has other forces."""
        weight, moment = self.mass * self.gravity, self.push * self.height / self.width
        if abs(self.push) >= self.friction * weight or abs(moment) >= 0.5 * weight:
            return {}
        return {
            "left force": 0.5 * weight - moment, "right force": 0.5 * weight + moment, "friction force": -self.push,
            "speed": 0.0, "rotation": 0.0,
        }  # fmt: skip

    def draw(self, solution: Any, axes: Any) -> None:
        """The box with the forces at its corners and its top, in parts of its weight."""
        found, unit = self.answer(solution), self.height / (self.mass * self.gravity)
        rectangle(axes, np.array([0.0, 0.5 * self.height, 0.0]), self.width, self.height)
        axes.axhline(0.0, color="0.4", linewidth=1.0)
        half = 0.5 * self.width
        arrow(axes, (-half, 0.0), (0.0, unit * found["left force"]), 0, f"left {found['left force']:.3g} N")
        arrow(axes, (half, 0.0), (0.0, unit * found["right force"]), 1, f"right {found['right force']:.3g} N")
        arrow(axes, (0.0, 0.0), (unit * found["friction force"], 0.0), 2, f"friction {found['friction force']:.3g} N")
        arrow(axes, (-half, self.height), (unit * self.push, 0.0), 3, f"push {self.push:.3g} N")
        axes.set(xlim=(-2 * self.width, 3 * self.width), ylim=(-0.1 * self.height, 1.2 * self.height))
        axes.set(aspect="equal", xticks=[], yticks=[])
        moves = 1e-9 * self.step * self.gravity
        turns, slides = abs(found["rotation"]) * self.height > moves, abs(found["speed"]) > moves
        axes.set_title("tips" if turns else "slides" if slides else "rests", fontsize="medium")
        axes.legend(loc="center right", fontsize="small", frameon=False)
