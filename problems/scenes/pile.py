"""A pile of boxes that falls together, in time steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE, NOT_NEGATIVE, integer
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.search.solver import solve
from problems.scenes.pictures import rectangle
from problems.scenes.planar import Contact, contact_unknowns, free_motion, impulses, time_step
from problems.scenes.rivals import LEMKE, TABLES, by_quantecon, by_tables
from problems.scenes.scene import Point, Quantities, Rival, Units, Unknown, positive

TIGHT = 1e-14
"""Relative residual of a step: with the default, 1e-10, boxes overlap by up to 1e-12 m, with this by 2e-16 m at most,
in the same time."""


@frozen(eq=False)
class Fall:
    """Places and velocities at all times, shape (steps + 1, boxes, 3), energies, least gaps, whether all went well."""

    places: Array
    velocities: Array
    energies: Array
    gaps: Array
    success: bool


@frozen
class Pile:
    """Boxes with gaps between them fall on each other, the lowest one sliding: where do they come to rest?

    Stewart and Trinkle's time steps: gaps are part of the problem, so that none is negative after a step, and no step
    gains energy. Impacts are inelastic.

    Parameters
    ----------
    boxes : int
    gap : float
        m, below each box at the beginning.
    side : float
        m, of the square boxes.
    mass : float
        kg, of each.
    friction : float
    speed : float
        m/s, of the lowest box.
    gravity : float
        m/s^2.
    step : float
        s.
    steps : int

    References
    ----------
    Stewart and Trinkle, Int. J. Numer. Methods Eng. 39 (1996); Anitescu and Potra, Nonlinear Dynamics 14 (1997).
    """

    boxes: int = field(default=4, validator=integer(1))
    gap: float = field(default=0.05, validator=NOT_NEGATIVE)
    side: float = positive(1.0)
    mass: float = positive(1.0)
    friction: float = field(default=0.5, validator=NOT_NEGATIVE)
    speed: float = field(default=1.0, validator=FINITE)
    gravity: float = positive(9.81)
    step: float = positive(0.01)
    steps: int = field(default=60, validator=integer(1))
    units: ClassVar[Units] = {
        "energy gained": "J", "deepest penetration": "m", "heights": "m", "slid": "m",
    }  # fmt: skip

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Two contacts a box: what touches along a side rests on the two ends of that."""
        return contact_unknowns(2 * self.boxes)

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """Lemke's method, in each step."""
        return _in_steps(LEMKE, by_quantecon), _in_steps(TABLES, by_tables)

    def _start(self) -> tuple[Array, Array]:
        """Places (x, y, angle) and velocities."""
        k = np.arange(self.boxes)
        places = np.zeros((self.boxes, 3))
        places[:, 1] = (k + 0.5) * self.side + (k + 1) * self.gap
        velocities = np.zeros((self.boxes, 3))
        velocities[0, 0] = self.speed
        return places, velocities

    def _contacts(self, places: Array) -> tuple[list[Contact], Array]:
        """The ends of each side that lies on what is below, and their distances from it."""
        contacts: list[Contact] = []
        gaps = []
        for k, (x, y, angle) in enumerate(places):
            half = 0.5 * self.side
            below = places[k - 1] if k else None
            ends = np.array([x - half, x + half])
            if below is not None:
                ends = np.clip(ends, below[0] - half, below[0] + half)
            for end in ends:
                height = y - half + (end - x) * np.sin(angle)
                floor = 0.0 if below is None else below[1] + half + (end - below[0]) * np.sin(below[2])
                contacts.append((k, k - 1, float(end), 0.5 * float(height + floor), 0.0, 1.0))
                gaps.append(height - floor)
        return contacts, np.array(gaps)

    def _step(self, places: Array, velocities: Array) -> tuple[LCP, Array, Array, Array]:
        """The problem of a step, J, the inverse masses, and velocities without contacts."""
        inertia = self.mass * self.side**2 / 6.0
        contacts, gaps = self._contacts(places)
        A, J, inverse = time_step([(self.mass, inertia, x, y) for x, y, _ in places], contacts, self.friction)
        free = velocities.ravel() + np.tile([0.0, -self.step * self.gravity, 0.0], self.boxes)
        u = J @ free
        u[::2] += gaps / self.step
        return LCP(A, free_motion(u)), J, inverse, free

    def problem(self) -> LCP:
        """The first step."""
        return self._step(*self._start())[0]

    def solve(self) -> Fall:
        """All steps."""
        return self._fall(lambda problem: solve(problem, tolerance=TIGHT))

    def _fall(self, solver: Callable[[LCP], Any]) -> Fall:
        """All steps, by any solver of one."""
        places, velocities = self._start()
        history, gaps, well = [(places, velocities)], [], True
        for _ in range(self.steps):
            problem, J, inverse, free = self._step(places, velocities)
            found = solver(problem)
            well = bool(found.success) and found.x is not None
            if not well:
                break
            velocities = (free + inverse * (J.T @ impulses(found.x))).reshape(-1, 3)
            places = places + self.step * velocities
            history.append((places, velocities))
            gaps.append(self._contacts(places)[1].min())
        where, fast = (np.array(part) for part in zip(*history))
        moving = 0.5 * self.mass * (fast[..., :2] ** 2).sum(axis=(1, 2))
        turning = 0.5 * self.mass * self.side**2 / 6.0 * (fast[..., 2] ** 2).sum(axis=1)
        energies = moving + turning + self.mass * self.gravity * where[..., 1].sum(axis=1)
        return Fall(where, fast, energies, np.array(gaps), well)

    def answer(self, solution: Any) -> Quantities:
        """What is to be zero, and where the boxes are at the end."""
        end = solution.places[-1]
        return {
            "energy gained": max(float(np.diff(solution.energies).max()), 0.0),
            "deepest penetration": max(-float(solution.gaps.min()), 0.0),
            "heights": end[:, 1], "slid": float(end[0, 0]),
        }  # fmt: skip

    def exact(self) -> Quantities:
        """No step gains energy or lets bodies overlap; after long enough the boxes lie on each other."""
        return {"energy gained": 0.0, "deepest penetration": 0.0}

    def draw(self, solution: Any, axes: Any) -> None:
        """The pile at the beginning, dashed, and at the end."""
        styles: tuple[dict[str, Any], ...] = (
            {"linestyle": "--", "facecolor": "none"},
            {"facecolor": "#56B4E9", "alpha": 0.6},
        )
        for places, style in zip((solution.places[0], solution.places[-1]), styles):
            for place in places:
                rectangle(axes, place, self.side, self.side, **style)
        axes.axhline(0.0, color="0.3", linewidth=1.0)
        axes.plot(solution.places[:, :, 0], solution.places[:, :, 1], ".", color="#D55E00", markersize=2)
        wide = 0.5 * self.boxes * self.side
        axes.set(aspect="equal", xlabel="m", ylabel="height (m)", xlim=(-wide, wide))
        axes.set_title(f"dashed: before, dots: middles, blue: after {self.steps * self.step:g} s", fontsize="medium")


def _in_steps(rival: Rival, method: Callable[[LCP], Array]) -> Rival:
    """The rival of that name, with its method for every step."""

    def run(scene: Pile) -> Quantities:
        return scene.answer(scene._fall(lambda problem: Point(method(problem))))

    return Rival(rival.name, rival.module, run)
