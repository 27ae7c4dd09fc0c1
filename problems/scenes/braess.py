"""Braess' paradox: a new road that makes every way longer."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Braess:
    """Drivers choose among two routes, or three with a bridge between them: how long do they take?

    A route takes 10 a car on each narrow road, 50 and 1 a car on each wide one; on the bridge 10 and 1 a car.

    Parameters
    ----------
    cars : float
    bridge : bool

    References
    ----------
    Braess, Unternehmensforschung 12 (1968); Wardrop, Proc. Inst. Civ. Eng. 1 (1952).
    """

    cars: float = positive(6.0)
    bridge: bool = True
    units: ClassVar[Units] = {"flows": "cars", "time": "minutes"}
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Routes and their common time; loads of roads are sums of flows."""
        return (
            Unknown("flows on routes", 2 + self.bridge, "which ways are taken"),
            Unknown("time", 1, "that of every route that is taken"),
        )

    def problem(self) -> LCP:
        """Times of routes less the least time, and cars that have arrived."""
        # Roads: narrow, wide, wide, narrow, bridge; routes: over the first two, the next two, narrow - bridge - narrow.
        routes = np.array([[1, 1, 0, 0, 0], [0, 0, 1, 1, 0], [1, 0, 0, 1, 1]], dtype=float)[: 2 + self.bridge]
        slope, empty = np.array([10.0, 1.0, 1.0, 10.0, 1.0]), np.array([0.0, 50.0, 50.0, 0.0, 10.0])
        one = np.ones((len(routes), 1))
        A = np.block([[(routes * slope) @ routes.T, -one], [one.T, np.zeros((1, 1))]])
        return LCP(A, np.append(routes @ empty, -self.cars))

    def answer(self, solution: Any) -> Quantities:
        """Cars on the routes, and the time that each takes."""
        return {"flows": np.asarray(solution.x[:-1]), "time": float(solution.x[-1])}

    def exact(self) -> Quantities:
        """Who takes the bridge is nobody, everybody, or as many as make the times equal."""
        x = self.cars
        over = float(np.clip((80.0 - 9.0 * x) / 13.0, 0.0, x)) if self.bridge else 0.0
        side = 0.5 * (x - over)
        flows: Array = np.array([side, side, over][: 2 + self.bridge])
        narrow = 10.0 * (side + over)
        time = narrow + 50.0 + side if side else 2.0 * narrow + 10.0 + over
        return {"flows": flows, "time": time}

    def draw(self, solution: Any, axes: Any) -> None:
        """The roads, as wide as their loads."""
        found = self.answer(solution)
        f = np.pad(found["flows"], (0, 3 - found["flows"].size))
        places = {"s": (0.0, 0.5), "a": (1.0, 1.0), "b": (1.0, 0.0), "t": (2.0, 0.5)}
        roads = [("s", "a", f[0] + f[2]), ("a", "t", f[0]), ("s", "b", f[1]), ("b", "t", f[1] + f[2])]
        for one, other, load in [*roads, *([("a", "b", f[2])] if self.bridge else [])]:
            (x0, y0), (x1, y1) = places[one], places[other]
            axes.plot([x0, x1], [y0, y1], color="#0072B2", linewidth=0.5 + 8.0 * load / self.cars, zorder=1)
            axes.annotate(f"{load:.3g}", (0.5 * (x0 + x1), 0.5 * (y0 + y1)), backgroundcolor="white", ha="center")
        axes.plot(*np.array(list(places.values())).T, "ko", zorder=2)
        axes.set(xlim=(-0.1, 2.1), ylim=(-0.2, 1.2), xticks=[], yticks=[])
        axes.set_title(f"each takes {found['time']:.4g} minutes", fontsize="medium")
