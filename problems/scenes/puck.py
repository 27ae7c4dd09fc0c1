"""A sliding puck: the friction cone as a pyramid."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import integer
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, arrow, mark, picture
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Finite, Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Puck(
    mass: Positive = 1.0, friction: Positive = 0.5, speed: Positive = 1.0, heading: Finite = 20.0,
    edges: Annotated[int, integer(3)] = 8, gravity: Positive = 9.81, step: Positive = 0.01,
) -> Scene:  # fmt: skip
    """How does friction bend and slow the motion of a puck on a rough plane?

    A pyramid replaces Coulomb's cone: friction is too small by at most a factor of cos(pi / edges).

    Parameters
    ----------
    mass, gravity, step : float
        kg, m/s^2, s.
    friction : float
    speed, heading : float
        Before the step: m/s, degrees from the first edge.
    edges : int
        Edges of the pyramid.

    References
    ----------
    Stewart and Trinkle, Int. J. Numer. Methods Eng. 39 (1996).
    """
    angle, towards = 2.0 * np.pi * np.arange(edges) / edges, np.deg2rad(heading)
    D, before = np.stack([np.cos(angle), np.sin(angle)]), speed * np.array([np.cos(towards), np.sin(towards)])

    def problem() -> LCP:
        A = np.zeros((edges + 2, edges + 2))
        A[0, 0], A[1:-1, 1:-1] = 1.0 / mass, D.T @ D / mass
        A[1:-1, -1], A[-1, 0], A[-1, 1:-1] = 1.0, friction, -1.0
        return LCP(A, np.concatenate([[-step * gravity], D.T @ before, [0.0]]))

    def answer(solution: Any) -> Quantities:
        along = D @ solution.x[1:-1]
        after = before + along / mass
        return {
            "speed": float(np.hypot(*after)), "heading": float(np.rad2deg(np.arctan2(after[1], after[0]))),
            "friction against motion": float(-along @ before) / speed,
        }  # fmt: skip

    def exact() -> Quantities:
        """For the round cone, whose friction opposes the motion."""
        loss = friction * gravity * step
        if loss >= speed:
            return {"speed": 0.0, "friction against motion": mass * speed}
        same = (heading + 180.0) % 360.0 - 180.0
        return {"speed": speed - loss, "heading": same, "friction against motion": mass * loss}

    def drawn(solution: Any) -> Picture:
        limit, round = friction * mass * gravity * step, np.linspace(0.0, 2.0 * np.pi, 200)
        return picture(
            mark("plot", limit * np.cos(round), limit * np.sin(round), color="0.7", label="cone"),
            mark("plot", *(limit * np.column_stack([D, D[:, 0]])), color="#0072B2", label="pyramid"),
            *arrow((0.0, 0.0), tuple(D @ solution.x[1:-1]), 1, "friction"),
            *arrow((0.0, 0.0), tuple(limit * before / speed), 2, "direction of the motion"),
            aspect="equal", xlabel="impulse (N s)", ylabel="impulse (N s)",
            legend={"fontsize": "small", "loc": "upper left", "bbox_to_anchor": (1.0, 1.0)},
        )  # fmt: skip

    return Scene(
        units={"speed": "m/s", "heading": "degrees", "friction against motion": "N s"},
        unknowns=(
            Unknown("normal impulse", 1, "the limit of friction"),
            Unknown("impulses along edges", edges, "friction in any direction"),
            Unknown("slip velocity", 1, "whether friction is at its limit"),
        ),
        problem=problem, answer=answer, exact=exact, picture=drawn, rivals=(LEMKE, TABLES),
    )  # fmt: skip
