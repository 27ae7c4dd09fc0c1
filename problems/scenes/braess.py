"""Braess' paradox."""

from __future__ import annotations

from typing import Any

import numpy as np

from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Braess(cars: Positive = 6.0, bridge: bool = True) -> Scene:
    """How long do drivers take who choose among two routes, or three with a bridge?

    A narrow road takes 10 minutes per car, a wide one 50 plus 1 per car, the bridge 10 plus 1.

    Parameters
    ----------
    cars : float
    bridge : bool

    References
    ----------
    Braess, Unternehmensforschung 12 (1968); Wardrop, Proc. Inst. Civ. Eng. 1 (1952).
    """
    # Roads: narrow, wide, wide, narrow, bridge.
    routes = np.array([[1, 1, 0, 0, 0], [0, 0, 1, 1, 0], [1, 0, 0, 1, 1]], dtype=float)[: 2 + bridge]
    slope, empty = np.array([10.0, 1.0, 1.0, 10.0, 1.0]), np.array([0.0, 50.0, 50.0, 0.0, 10.0])
    one = np.ones((len(routes), 1))
    A = np.block([[(routes * slope) @ routes.T, -one], [one.T, np.zeros((1, 1))]])

    def exact() -> Quantities:
        over = float(np.clip((80.0 - 9.0 * cars) / 13.0, 0.0, cars)) if bridge else 0.0
        side = 0.5 * (cars - over)
        narrow = 10.0 * (side + over)
        time = narrow + 50.0 + side if side else 2.0 * narrow + 10.0 + over
        return {"flows": np.array([side, side, over][: 2 + bridge]), "time": time}

    def drawn(solution: Any) -> Picture:
        f = np.pad(solution.x[:-1], (0, 3 - len(routes)))
        places = {"s": (0.0, 0.5), "a": (1.0, 1.0), "b": (1.0, 0.0), "t": (2.0, 0.5)}
        roads = [("s", "a", f[0] + f[2]), ("a", "t", f[0]), ("s", "b", f[1]), ("b", "t", f[1] + f[2]), ("a", "b", f[2])]
        ways = [(*np.transpose([places[one], places[other]]), load) for one, other, load in roads[: 4 + bridge]]
        return picture(
            *(mark("plot", x, y, color="#0072B2", linewidth=0.5 + 8.0 * load / cars, zorder=1) for x, y, load in ways),
            *(mark("annotate", f"{load:.3g}", (x.mean(), y.mean()), backgroundcolor="white", ha="center")
              for x, y, load in ways),
            mark("plot", *np.array(list(places.values())).T, "ko", zorder=2),
            xlim=(-0.1, 2.1), ylim=(-0.2, 1.2), xticks=[], yticks=[],
            title=f"each takes {solution.x[-1]:.4g} minutes",
        )  # fmt: skip

    return Scene(
        units={"flows": "cars", "time": "minutes"},
        unknowns=(
            Unknown("flows on routes", len(routes), "which ways are taken"),
            Unknown("time", 1, "that of every route that is taken"),
        ),
        problem=lambda: LCP(A, np.append(routes @ empty, -cars)),
        answer=lambda solution: {"flows": np.asarray(solution.x[:-1]), "time": float(solution.x[-1])},
        exact=exact, picture=drawn, rivals=(LEMKE, TABLES),
    )  # fmt: skip
