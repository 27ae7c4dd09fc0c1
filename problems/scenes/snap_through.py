"""A shallow truss snapping onto a stop."""

from __future__ import annotations

from math import sqrt
from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import number
from continuation.arrays import Array
from problems.nonlinear.normal_map import NormalMap
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


def _lack(x: Any, lam: Any) -> Any:
    """Unbalanced upward force over stiffness rise^3 / span^3."""
    return x**3 - x + lam


def _slope(x: Array, lam: float) -> tuple[Array, Array]:
    return np.diag(3.0 * x**2 - 1.0), np.ones(1)


@with_parameters
def SnapThrough(
    rise: Positive = 0.05, span: Positive = 1.0, stiffness: Positive = 1e6,
    stop: Annotated[float, number("a number between -1 and 0", lambda s: -1.0 < s < 0.0)] = -0.3,
    load: Positive = 1.5,
) -> Scene:  # fmt: skip
    """When do two shallow bars snap through onto a stop, and what does the stop bear?

    The height's path turns at a fold, and at a kink where the joint touches the stop.

    Parameters
    ----------
    rise, span : float
        m: height of the joint above the supports, and its horizontal distance.
    stiffness : float
        N: Young's modulus times bar section.
    stop : float
        Stop height / rise, below 0.
    load : float
        Load / fold load, where the stop's force is reported.

    References
    ----------
    von Mises, Z. angew. Math. Mech. 3 (1923).
    """
    unit, top = stiffness * (rise / span) ** 3, 2.0 / (3.0 * sqrt(3.0))
    asked = load * 2.0 / (3.0 * sqrt(3.0))

    def named(fold: float, kink: float, force: float) -> Quantities:
        return {"snap load": unit * fold, "load at touch": unit * kink, "force on stop": unit * max(force, 0.0)}

    def answer(solution: Any) -> Quantities:
        """The stop's force is the depth of z below the stop."""
        (kink,) = solution.kinks
        return named(solution.turning_points[0].lam, kink.lam, stop - float(solution.crossings(asked)[-1][0]))

    def exact() -> Quantities:
        touch = stop - stop**3
        return named(top, touch, load * top - touch)

    def drawn(solution: Any) -> Picture:
        def shown(u: Array, *style: str, **options: Any) -> Any:
            return mark("plot", rise * np.maximum(u[:, 0], stop), unit * u[:, 1], *style, **options)

        special = ((solution.turning_points, "wo", "fold"), (solution.kinks, "kD", "touches the stop"))
        return picture(
            shown(solution(np.linspace(0.0, solution.arclength[-1], 400)), color="#0072B2"),
            *(shown(np.reshape([event.u for event in events], (-1, 2)), style, markersize=6, markeredgecolor="black",
                    label=label) for events, style, label in special),
            mark("axvline", rise * stop, color="0.7", linewidth=3.0, zorder=0),
            mark("invert_xaxis"), xlabel="height of the joint (m)", ylabel="load (N)",
        )  # fmt: skip

    return Scene(
        units={"snap load": "N", "load at touch": "N", "force on stop": "N"},
        unknowns=(Unknown("height of the joint", 1, "where it is when it touches the stop"),),
        answer=answer, exact=exact, picture=drawn,
        problem=lambda: NormalMap(
            _lack, _slope, x0=np.ones(1), lam0=0.0, lower=stop, upper=np.inf, target=1.1 * max(asked, top)
        ),
    )  # fmt: skip
