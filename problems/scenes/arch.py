"""A masonry arch."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import integer
from problems.lcp.data.program import from_lp
from problems.scenes.pictures import Mark, Picture, mark, picture
from problems.scenes.rivals import PIQP
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Arch(
    radius: Positive = 1.0, thickness: Positive = 0.15, stones: Annotated[int, integer(2)] = 20,
    weight: Positive = 2e4,
) -> Scene:  # fmt: skip
    """How thin may a half circle of stones be whose radial joints take no tension and do not slide?

    It stands if a line of thrust lies within every joint (safe theorem). The program maximises the least spare moment.

    Parameters
    ----------
    radius, thickness : float
        m; the radius is the mean one.
    stones : int
        Per half.
    weight : float
        N/m^3.

    References
    ----------
    Milankovitch, Z. Math. Phys. 55 (1907); Heyman, Int. J. Solids Struct. 2 (1966); Ochsendorf, Structural Engineer 84
    (2006), for .1075.
    """
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    unit = weight * radius * thickness
    angle = np.linspace(0.0, 0.5 * np.pi, stones + 1)
    above = weight * 0.5 * (outer**2 - inner**2) * angle
    moment = weight * (outer**3 - inner**3) / 3.0 * (1.0 - np.cos(angle))
    # Max z: inner N + z <= M <= outer N - z (moment M, normal force N).
    one, across = np.ones(angle.size), np.stack([np.cos(angle), np.zeros(angle.size)], axis=1)
    G = np.concatenate([
        np.column_stack([inner * across - [0.0, 1.0], one]), np.column_stack([[0.0, 1.0] - outer * across, one]),
    ])  # fmt: skip
    h = np.concatenate([moment - inner * above * np.sin(angle), outer * above * np.sin(angle) - moment])

    def answer(solution: Any) -> Quantities:
        thrust, _, spare = unit * solution.x[:3]
        return {"thrust": thrust, "spare moment": spare, "stands": float(spare >= 0.0)}

    def exact() -> Quantities:
        """Near the limit .1075 the number of stones decides."""
        ratio = thickness / radius
        return {"stands": float(ratio > 0.1075)} if abs(ratio - 0.1075) > 0.002 and stones >= 20 else {}

    def drawn(solution: Any) -> Picture:
        thrust, own, spare = unit * solution.x[:3]
        force = thrust * np.cos(angle) + above * np.sin(angle)
        r, joint = (own + moment) / force, np.array([inner, outer])
        near = np.minimum(own + moment - inner * force, outer * force - own - moment) <= spare + 1e-9 * unit

        def half(side: float, label: str) -> list[Mark]:
            return [
                *(mark("plot", side * np.sin(a) * joint, np.cos(a) * joint, color="0.7") for a in angle),
                *(mark("plot", side * edge * np.sin(angle), edge * np.cos(angle), color="0.3") for edge in joint),
                mark("plot", side * r * np.sin(angle), r * np.cos(angle), color="#D55E00", label=label),
                mark("plot", side * (r * np.sin(angle))[near], (r * np.cos(angle))[near], "ko", markersize=4),
            ]

        return picture(
            *half(-1.0, ""), *half(1.0, "line of thrust"),
            aspect="equal", xlabel="m from the middle", ylabel="height (m)",
            title=f"{'stands' if spare >= 0.0 else 'falls'}: {spare:.3g} N to spare", legend={"loc": "center"},
        )  # fmt: skip

    return Scene(
        units={"thrust": "N/m", "spare moment": "N", "stands": ""},
        unknowns=(
            Unknown("thrust, its moment, spare moment", 3, "every other force follows by equilibrium"),
            Unknown("rotations", 2 * (stones + 1), "at which joints hinges open, inside or outside"),
        ),
        problem=lambda: from_lp([0.0, 0.0, -1.0], G, h / unit),
        answer=answer, exact=exact, picture=drawn, rivals=(PIQP,),
    )  # fmt: skip
