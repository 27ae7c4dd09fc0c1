"""A block on a plane: it slides, or friction holds it."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE, NOT_NEGATIVE
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import arrow
from problems.scenes.planar import contact_unknowns, free_motion, impulses, time_step
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Block:
    """A block on a plane, pushed or not: does it slide, or does friction hold it?

    One time step. Its rotation is not modelled, so one contact is enough.

    Parameters
    ----------
    mass : float
        kg.
    friction : float
        Coulomb's coefficient.
    speed : float
        m/s, before the step.
    push : float
        N, along the plane.
    gravity : float
        m/s^2.
    step : float
        s.

    References
    ----------
    Stewart and Trinkle, Int. J. Numer. Methods Eng. 39 (1996).
    """

    mass: float = positive(1.0)
    friction: float = field(default=0.5, validator=NOT_NEGATIVE)
    speed: float = field(default=1.0, validator=FINITE)
    push: float = field(default=0.0, validator=FINITE)
    gravity: float = positive(9.81)
    step: float = positive(0.01)
    units: ClassVar[Units] = {"normal impulse": "N s", "friction impulse": "N s", "speed": "m/s"}
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Four, or the normal impulse alone where there is no friction."""
        return contact_unknowns(1) if self.friction else contact_unknowns(1)[:1]

    def problem(self) -> LCP:
        """Stewart and Trinkle's step."""
        A, _, _ = time_step([(self.mass, 1.0, 0.0, 0.0)], [(0, -1, 0.0, 0.0, 0.0, 1.0)], self.friction)
        q = free_motion(np.array([-self.step * self.gravity, self._free]))
        n = sum(kind.count for kind in self.unknowns)
        return LCP(A[:n, :n], q[:n])

    @property
    def _free(self) -> float:
        """The speed after the step without friction."""
        return self.speed + self.step * self.push / self.mass

    def answer(self, solution: Any) -> Quantities:
        """Impulses of the plane on the block, and its speed after the step."""
        normal, along = impulses(np.pad(solution.x, (0, 4 - solution.x.size)))
        return {"normal impulse": normal, "friction impulse": along, "speed": self._free + along / self.mass}

    def exact(self) -> Quantities:
        """Friction stops the block, or is at its limit."""
        normal = self.mass * self.gravity * self.step
        along = -float(np.clip(self.mass * self._free, -self.friction * normal, self.friction * normal))
        return {"normal impulse": normal, "friction impulse": along, "speed": self._free + along / self.mass}

    def draw(self, solution: Any, axes: Any) -> None:
        """The block, the impulses on it, and its velocity after the step."""
        found = self.answer(solution)
        axes.fill([-0.5, 0.5, 0.5, -0.5], [0.0, 0.0, 0.6, 0.6], color="0.85")
        axes.axhline(0.0, color="0.4", linewidth=1.0)
        friction = found["friction impulse"] / found["normal impulse"]
        arrow(axes, (0.0, 0.0), (0.0, 1.0), 0, f"normal impulse {found['normal impulse']:.4g} N s")
        arrow(axes, (0.0, 0.0), (friction, 0.0), 1, f"friction impulse {found['friction impulse']:.4g} N s")
        arrow(axes, (0.0, 0.3), (np.sign(found["speed"]), 0.0), 2, f"{found['speed']:.4g} m/s after the step")
        axes.set(xlim=(-1.5, 1.5), ylim=(-0.2, 1.9), aspect="equal", xticks=[], yticks=[])
        axes.set_title("slides" if found["speed"] else "sticks", fontsize="medium")
        axes.legend(loc="upper right", fontsize="small", frameon=False)
