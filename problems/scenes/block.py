"""A block on a rough plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, arrow, mark, picture
from problems.scenes.planar import contact_unknowns, free_motion, impulses, time_step
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Finite, NotNegative, Positive, Quantities, Scene, with_parameters


@with_parameters
def Block(
    mass: Positive = 1.0, friction: NotNegative = 0.5, speed: Finite = 1.0, push: Finite = 0.0,
    gravity: Positive = 9.81, step: Positive = 0.01,
) -> Scene:  # fmt: skip
    """Does a block on a plane slide under a push, or does friction hold it?

    Parameters
    ----------
    mass, gravity, step : float
        kg, m/s^2, s.
    friction : float
        Coulomb's coefficient.
    speed, push : float
        Before the step, m/s; along the plane, N.

    References
    ----------
    Stewart and Trinkle, Int. J. Numer. Methods Eng. 39 (1996).
    """
    A, _, _ = time_step([(mass, 1.0, 0.0, 0.0)], [(0, -1, 0.0, 0.0, 0.0, 1.0)], friction)
    free = speed + step * push / mass
    q = free_motion(np.array([-step * gravity, free]))
    n = 4 if friction else 1

    def after(normal: float, along: float) -> Quantities:
        return {"normal impulse": normal, "friction impulse": along, "speed": free + along / mass}

    def exact() -> Quantities:
        normal = mass * gravity * step
        return after(normal, -float(np.clip(mass * free, -friction * normal, friction * normal)))

    def answer(solution: Any) -> Quantities:
        return after(*impulses(np.pad(solution.x, (0, 4 - solution.x.size))))

    def drawn(solution: Any) -> Picture:
        normal, along, speed = answer(solution).values()
        return picture(
            mark("fill", [-0.5, 0.5, 0.5, -0.5], [0.0, 0.0, 0.6, 0.6], color="0.85"),
            mark("axhline", 0.0, color="0.4", linewidth=1.0),
            *arrow((0.0, 0.0), (0.0, 1.0), 0, f"normal impulse {normal:.4g} N s"),
            *arrow((0.0, 0.0), (along / normal, 0.0), 1, f"friction impulse {along:.4g} N s"),
            *arrow((0.0, 0.3), (np.sign(speed), 0.0), 2, f"{speed:.4g} m/s after the step"),
            xlim=(-1.5, 1.5), ylim=(-0.2, 1.9), aspect="equal", xticks=[], yticks=[],
            title="slides" if speed else "sticks", legend={"loc": "upper right", "fontsize": "small"},
        )  # fmt: skip

    return Scene(
        units={"normal impulse": "N s", "friction impulse": "N s", "speed": "m/s"},
        unknowns=contact_unknowns(1) if friction else contact_unknowns(1)[:1],
        problem=lambda: LCP(A[:n, :n], q[:n]),
        answer=answer, exact=exact, picture=drawn, rivals=(LEMKE, TABLES),
    )  # fmt: skip
