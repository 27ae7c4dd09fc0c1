"""A pushed box."""

from __future__ import annotations

from typing import Any

import numpy as np

from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, arrow, mark, picture, rectangle
from problems.scenes.planar import contact_unknowns, free_motion, impulses, time_step
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Finite, NotNegative, Positive, Quantities, Scene, with_parameters


@with_parameters
def Box(
    width: Positive = 1.0, height: Positive = 2.0, mass: Positive = 1.0, friction: NotNegative = 0.5,
    push: Finite = 2.0, gravity: Positive = 9.81, step: Positive = 0.01,
) -> Scene:  # fmt: skip
    """Does a box on a rough floor, pushed at its top, rest, slide, or tip?

    Parameters
    ----------
    width, height : float
        m.
    mass, gravity, step : float
        kg, m/s^2, s.
    friction : float
    push : float
        N, to the right.
    """
    half, inertia, weight = 0.5 * width, mass * (width**2 + height**2) / 12.0, mass * gravity
    corners = [(0, -1, side, 0.0, 0.0, 1.0) for side in (-half, half)]
    A, J, inverse = time_step([(mass, inertia, 0.0, 0.5 * height)], corners, friction)
    free = step * inverse * np.array([push, -mass * gravity, -0.5 * push * height])

    def answer(solution: Any) -> Quantities:
        p = impulses(solution.x)
        velocity = free + inverse * (J.T @ p)
        left, right = p[::2] / step
        return {
            "left force": left, "right force": right, "friction force": float(p[1::2].sum()) / step,
            "speed": velocity[0], "rotation": velocity[2],
        }  # fmt: skip

    def exact() -> Quantities:
        """Only a box at rest has a closed form."""
        moment = push * height / width
        if abs(push) >= friction * weight or abs(moment) >= 0.5 * weight:
            return {}
        return {
            "left force": 0.5 * weight - moment, "right force": 0.5 * weight + moment, "friction force": -push,
            "speed": 0.0, "rotation": 0.0,
        }  # fmt: skip

    def drawn(solution: Any) -> Picture:
        left, right, friction, speed, rotation = answer(solution).values()
        unit, moves = height / weight, 1e-9 * step * gravity
        return picture(
            rectangle(np.array([0.0, 0.5 * height, 0.0]), width, height),
            mark("axhline", 0.0, color="0.4", linewidth=1.0),
            *arrow((-half, 0.0), (0.0, unit * left), 0, f"left {left:.3g} N"),
            *arrow((half, 0.0), (0.0, unit * right), 1, f"right {right:.3g} N"),
            *arrow((0.0, 0.0), (unit * friction, 0.0), 2, f"friction {friction:.3g} N"),
            *arrow((-half, height), (unit * push, 0.0), 3, f"push {push:.3g} N"),
            xlim=(-2 * width, 3 * width), ylim=(-0.1 * height, 1.2 * height), aspect="equal", xticks=[], yticks=[],
            title="tips" if abs(rotation) * height > moves else "slides" if abs(speed) > moves else "rests",
            legend={"loc": "center right", "fontsize": "small"},
        )  # fmt: skip

    return Scene(
        units={"left force": "N", "right force": "N", "friction force": "N", "speed": "m/s", "rotation": "rad/s"},
        unknowns=contact_unknowns(2),
        problem=lambda: LCP(A, free_motion(J @ free)),
        answer=answer, exact=exact, picture=drawn, rivals=(LEMKE, TABLES),
    )  # fmt: skip
