"""Traffic on a grid of streets, where everybody takes the quickest way."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from scipy.sparse.csgraph import dijkstra

from continuation.arguments.checks import integer
from continuation.arrays import Array
from problems.lcp.data.program import Program, from_qp
from problems.scenes.rivals import CLARABEL, PIQP
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Traffic:
    """A grid of streets whose times grow with their loads: which ways do drivers take from corner to corner?

    Beckmann's program: its multipliers are the times from the crossings to the goal. Every street has times of its own,
    drawn at random, so that no symmetry makes the model smaller.

    Parameters
    ----------
    side : int
        Crossings in a row.
    cars : float
        An hour, in hundreds.
    seed : int
        Of the times.

    References
    ----------
    Beckmann, McGuire and Winsten, Studies in the Economics of Transportation, 1956.
    """

    side: int = field(default=5, validator=integer(2))
    cars: float = positive(10.0)
    seed: int = field(default=0, validator=integer(0))
    units: ClassVar[Units] = {"time": "minutes", "quickest way": "minutes", "loads": "hundred cars an hour"}
    rivals: ClassVar[tuple[Rival, ...]] = (PIQP, CLARABEL)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Loads of streets, not of routes, of which there are far more; one goal, so one flow."""
        return (
            Unknown("loads of streets", 2 * self.side * (self.side - 1), "who drives where"),
            Unknown("times to the goal", self.side**2 - 1, "cars that come to a crossing leave it"),
        )

    def _streets(self) -> tuple[Array, Array]:
        """From and to which crossing."""
        place = np.arange(self.side**2).reshape(self.side, self.side)
        begin = np.concatenate([place[:, :-1].ravel(), place[:-1].ravel()])
        end = np.concatenate([place[:, 1:].ravel(), place[1:].ravel()])
        return begin, end

    def _times(self) -> tuple[Array, Array]:
        """Minutes on an empty street, and by how many each hundred cars lengthens them."""
        random = np.random.default_rng(self.seed)
        streets = 2 * self.side * (self.side - 1)
        return random.uniform(1.0, 5.0, streets), random.uniform(0.1, 1.0, streets)

    def problem(self) -> Program:
        """Min sum of slope load^2 / 2 + empty load: what leaves a crossing less what comes is what starts there."""
        begin, end = self._streets()
        empty, slope = self._times()
        one, street = np.ones(begin.size), np.arange(begin.size)
        whole = sp.coo_array((np.concatenate([one, -one]), (np.concatenate([begin, end]), np.tile(street, 2))))
        starts = np.zeros(self.side**2 - 1)
        starts[0] = self.cars
        return from_qp(sp.diags_array(slope, format="csr"), empty, A_eq=whole.tocsr()[:-1], b_eq=starts, lower=0.0)

    def answer(self, solution: Any) -> Quantities:
        """The mean time of the cars, which is that of the quickest way, and the loads."""
        begin, end = self._streets()
        empty, slope = self._times()
        loads = np.maximum(np.asarray(solution.x)[: begin.size], 0.0)
        minutes = empty + slope * loads
        graph = sp.csr_array((minutes, (begin, end)), shape=(self.side**2,) * 2)
        quickest = dijkstra(graph, indices=0)[-1]
        return {"time": float(minutes @ loads) / self.cars, "quickest way": float(quickest), "loads": loads}

    def exact(self) -> Quantities:
        """On two by two crossings the two ways share the cars so that they take the same time."""
        if self.side > 2:
            return {}
        empty, slope = self._times()
        ways = [[0, 3], [2, 1]]
        fixed, each = (np.array([part[way].sum() for way in ways]) for part in (empty, slope))
        first = float(np.clip((fixed[1] - fixed[0] + each[1] * self.cars) / each.sum(), 0.0, self.cars))
        time = fixed[0] + each[0] * first if first > 0.0 else fixed[1] + each[1] * self.cars
        return {"time": time, "quickest way": time, "loads": np.array([first, self.cars - first] * 2)[[0, 1, 1, 0]]}

    def draw(self, solution: Any, axes: Any) -> None:
        """The streets, as wide as their loads."""
        begin, end = self._streets()
        found = self.answer(solution)
        for a, b, load in zip(begin, end, found["loads"]):
            (y0, x0), (y1, x1) = divmod(int(a), self.side), divmod(int(b), self.side)
            axes.plot([x0, x1], [-y0, -y1], color="#0072B2", linewidth=0.4 + 10.0 * load / self.cars, zorder=1,
                      solid_capstyle="round")  # fmt: skip
        across, down = np.meshgrid(range(self.side), range(self.side))
        axes.plot(across.ravel(), -down.ravel(), "o", color="0.3", markersize=4)
        axes.set(aspect="equal", xticks=[], yticks=[])
        axes.set_title(
            f"each takes {found['time']:.4g} minutes from the upper left to the lower right", fontsize="medium"
        )
