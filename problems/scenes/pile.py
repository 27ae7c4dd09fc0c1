"""A falling pile of boxes."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from attrs import frozen

from continuation.arguments.checks import integer
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.search.solver import solve
from problems.scenes.pictures import Picture, mark, picture, rectangle
from problems.scenes.planar import Contact, contact_unknowns, free_motion, impulses, time_step
from problems.scenes.scene import (
    Finite,
    NotNegative,
    Positive,
    Scene,
    with_parameters,
)

TIGHT = 1e-14
"""Relative residual of a step: with the default 1e-10 boxes overlap by up to 1e-12 m, with this one by 2e-16 m."""


@frozen(eq=False)
class Fall:
    """Places and velocities have the shape (steps + 1, boxes, 3)."""

    places: Array
    velocities: Array
    energies: Array
    gaps: Array
    success: bool


@with_parameters
def Pile(
    boxes: Annotated[int, integer(1)] = 4, gap: NotNegative = 0.05, side: Positive = 1.0, mass: Positive = 1.0,
    friction: NotNegative = 0.5, speed: Finite = 1.0, gravity: Positive = 9.81, step: Positive = 0.01,
    steps: Annotated[int, integer(1)] = 60,
) -> Scene:  # fmt: skip
    """Where do boxes that fall on each other come to rest?

    Stewart and Trinkle's time steps keep gaps nonnegative and gain no energy.

    Parameters
    ----------
    boxes, steps : int
    gap : float
        m, below each box at the start.
    side, mass : float
        m and kg, each box.
    friction : float
    speed : float
        m/s, sideways, lowest box.
    gravity, step : float
        m/s^2, s.

    References
    ----------
    Stewart and Trinkle, Int. J. Numer. Methods Eng. 39 (1996); Anitescu and Potra, Nonlinear Dynamics 14 (1997).
    """
    half, inertia, k = 0.5 * side, mass * side**2 / 6.0, np.arange(boxes)
    start = np.stack([0.0 * k, (k + 0.5) * side + (k + 1) * gap, 0.0 * k], axis=1), np.outer(k == 0, [speed, 0.0, 0.0])

    def touching(places: Array) -> tuple[list[Contact], Array]:
        """Contacts at the ends of each supported side, and their gaps."""
        contacts: list[Contact] = []
        gaps = []
        for k, (x, y, angle) in enumerate(places):
            # The floor is as wide as a box.
            under, top, turn = (places[k - 1, 0], places[k - 1, 1] + half, places[k - 1, 2]) if k else (x, 0.0, 0.0)
            for end in np.clip([x - half, x + half], under - half, under + half):
                height = y - half + (end - x) * np.sin(angle)
                floor = top + (end - under) * np.sin(turn)
                contacts.append((k, k - 1, float(end), 0.5 * float(height + floor), 0.0, 1.0))
                gaps.append(height - floor)
        return contacts, np.array(gaps)

    def stepped(places: Array, velocities: Array) -> tuple[LCP, Array, Array, Array]:
        """LCP of a step, J, inverse masses, contact-free velocities."""
        contacts, gaps = touching(places)
        A, J, inverse = time_step([(mass, inertia, x, y) for x, y, _ in places], contacts, friction)
        free = velocities.ravel() + np.tile([0.0, -step * gravity, 0.0], boxes)
        u = J @ free
        u[::2] += gaps / step
        return LCP(A, free_motion(u)), J, inverse, free

    def fall() -> Fall:
        (places, velocities), history, well = start, [start], True
        for _ in range(steps):
            problem, J, inverse, free = stepped(places, velocities)
            found: Any = solve(problem, tolerance=TIGHT)
            well = bool(found.success) and found.x is not None
            if not well:
                break
            velocities = (free + inverse * (J.T @ impulses(found.x))).reshape(-1, 3)
            places = places + step * velocities
            history.append((places, velocities))
        where, fast = (np.array(part) for part in zip(*history))
        moving = 0.5 * mass * (fast[..., :2] ** 2).sum(axis=(1, 2))
        turning = 0.5 * inertia * (fast[..., 2] ** 2).sum(axis=1)
        energies = moving + turning + mass * gravity * where[..., 1].sum(axis=1)
        return Fall(where, fast, energies, np.array([touching(one)[1].min() for one in where[1:]]), well)

    def drawn(solution: Any) -> Picture:
        places, wide = solution.places, 0.5 * boxes * side
        return picture(
            *(rectangle(place, side, side, linestyle="--", facecolor="none") for place in places[0]),
            *(rectangle(place, side, side, facecolor="#56B4E9", alpha=0.6) for place in places[-1]),
            mark("axhline", 0.0, color="0.3", linewidth=1.0),
            mark("plot", places[:, :, 0], places[:, :, 1], ".", color="#D55E00", markersize=2),
            aspect="equal", xlabel="m", ylabel="height (m)", xlim=(-wide, wide),
            title=f"dashed: before, dots: middles, blue: after {steps * step:g} s",
        )  # fmt: skip

    return Scene(
        units={"energy gained": "J", "deepest penetration": "m", "heights": "m", "slid": "m"},
        unknowns=contact_unknowns(2 * boxes),
        problem=lambda: stepped(*start)[0],
        solve=fall,
        picture=drawn,
        answer=lambda solution: {
            "energy gained": max(float(np.diff(solution.energies).max()), 0.0),
            "deepest penetration": max(-float(solution.gaps.min()), 0.0),
            "heights": solution.places[-1, :, 1], "slid": float(solution.places[-1, 0, 0]),
        },
        exact=lambda: {"energy gained": 0.0, "deepest penetration": 0.0},
    )  # fmt: skip
