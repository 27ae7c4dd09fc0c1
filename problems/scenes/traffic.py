"""Traffic equilibrium on a grid."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import dijkstra

from continuation.arguments.checks import integer
from problems.lcp.data.program import Program, from_qp
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import PIQP
from problems.scenes.scene import Positive, Quantities, Scene, Seed, Unknown, with_parameters


@with_parameters
def Traffic(side: Annotated[int, integer(2)] = 5, cars: Positive = 10.0, seed: Seed = 0) -> Scene:
    """Which ways do drivers take across a grid of streets whose times grow with their loads?

    The multipliers of Beckmann's program are times to the goal.

    Parameters
    ----------
    side, seed : int
        Crossings per row; seed of the times.
    cars : float
        Hundreds per hour.

    References
    ----------
    Beckmann, McGuire and Winsten, Studies in the Economics of Transportation, 1956.
    """
    place, streets = np.arange(side**2).reshape(side, side), 2 * side * (side - 1)
    begin = np.concatenate([place[:, :-1].ravel(), place[:-1].ravel()])
    end = np.concatenate([place[:, 1:].ravel(), place[1:].ravel()])
    # Minutes when empty, and per hundred cars.
    random = np.random.default_rng(seed)
    empty, slope = random.uniform(1.0, 5.0, streets), random.uniform(0.1, 1.0, streets)

    def problem() -> Program:
        one, street = np.ones(streets), np.arange(streets)
        whole = sp.coo_array((np.concatenate([one, -one]), (np.concatenate([begin, end]), np.tile(street, 2))))
        starts = np.append(cars, np.zeros(side**2 - 2))
        return from_qp(sp.diags_array(slope, format="csr"), empty, A_eq=whole.tocsr()[:-1], b_eq=starts, lower=0.0)

    def answer(solution: Any) -> Quantities:
        """The mean time is that of the quickest way."""
        loads = np.maximum(np.asarray(solution.x)[:streets], 0.0)
        minutes = empty + slope * loads
        quickest = dijkstra(sp.csr_array((minutes, (begin, end)), shape=(side**2,) * 2), indices=0)[-1]
        return {"time": float(minutes @ loads) / cars, "quickest way": float(quickest), "loads": loads}

    def drawn(solution: Any) -> Picture:
        found = answer(solution)
        (y0, x0), (y1, x1) = (np.divmod(ends, side) for ends in (begin, end))
        across, down = np.meshgrid(range(side), range(side))
        return picture(
            *(mark("plot", x, y, color="#0072B2", linewidth=0.4 + 10.0 * load / cars, zorder=1,
                   solid_capstyle="round") for x, y, load in zip(np.c_[x0, x1], -np.c_[y0, y1], found["loads"])),
            mark("plot", across.ravel(), -down.ravel(), "o", color="0.3", markersize=4),
            aspect="equal", xticks=[], yticks=[],
            title=f"each takes {found['time']:.4g} minutes from the upper left to the lower right",
        )  # fmt: skip

    return Scene(
        units={"time": "minutes", "quickest way": "minutes", "loads": "hundred cars an hour"},
        unknowns=(
            Unknown("loads of streets", streets, "who drives where"),
            Unknown("times to the goal", side**2 - 1, "cars that come to a crossing leave it"),
        ),
        problem=problem, answer=answer, picture=drawn, rivals=(PIQP,),
    )  # fmt: skip
