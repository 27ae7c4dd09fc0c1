"""Spatial prices: goods go where the price pays for the way."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import NOT_NEGATIVE
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.rivals import LEMKE, QUADRATIC, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, numbers, positive


def trade(supply: tuple[Array, Array], demand: tuple[Array, Array], freight: Array) -> LCP:
    """The flows from m places of supply to k of demand, by rows, with linear prices and costs of freight, shape (m, k).

    Supply and demand are the prices at no supply or demand, and by how much they rise or fall with each unit.
    """
    (a, b), (c, e) = supply, demand
    out, to = np.kron(np.eye(a.size), np.ones((1, c.size))), np.kron(np.ones((1, a.size)), np.eye(c.size))
    A = out.T @ np.diag(b) @ out + to.T @ np.diag(e) @ to
    return LCP(A, out.T @ a - to.T @ c + freight.ravel())


@frozen
class SpatialPrices:
    """Producers and markets in several places: who delivers where, and what does it cost there?

    Parameters
    ----------
    offers : sequence of float
        Prices at which producers begin to deliver.
    rise : float
        Of these with each unit.
    bids : sequence of float
        Prices at which markets begin to buy.
    fall : float
        Of these with each unit.
    freight : float
        A unit and a place: from place i to place j it is (1 + |i - j|) times that.

    References
    ----------
    Samuelson, Amer. Econ. Review 42 (1952); Takayama and Judge, Spatial and Temporal Price and Allocation Models, 1971.
    """

    offers: tuple[float, ...] = numbers("offers", (4.0, 8.0, 12.0))
    rise: float = positive(1.0)
    bids: tuple[float, ...] = numbers("bids", (14.0, 30.0, 22.0))
    fall: float = positive(1.0)
    freight: float = field(default=2.0, validator=NOT_NEGATIVE)
    units: ClassVar[Units] = {
        "flows": "units",
        "offers": "money a unit",
        "bids": "money a unit",
        "trade": "",
    }
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES, *QUADRATIC)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Flows alone: supplies, demands and prices are sums of them."""
        return (Unknown("flows", len(self.offers) * len(self.bids), "who delivers where"),)

    @property
    def _costs(self) -> Array:
        i, j = np.indices((len(self.offers), len(self.bids)))
        return np.asarray(self.freight * (1.0 + np.abs(i - j)))

    def problem(self) -> LCP:
        """What a delivery costs more than it brings."""
        m, k = len(self.offers), len(self.bids)
        supply = np.array(self.offers), np.full(m, self.rise)
        return trade(supply, (np.array(self.bids), np.full(k, self.fall)), self._costs)

    def answer(self, solution: Any) -> Quantities:
        """Flows, and prices at both ends. Flows on ways of equal cost may be exchanged; prices and the trade not."""
        flows = np.asarray(solution.x).reshape(len(self.offers), len(self.bids))
        return {
            "flows": flows, "offers": np.array(self.offers) + self.rise * flows.sum(axis=1),
            "bids": np.array(self.bids) - self.fall * flows.sum(axis=0), "trade": float(flows.sum()),
        }  # fmt: skip

    def exact(self) -> Quantities:
        """For one producer and one market."""
        if len(self.offers) != 1 or len(self.bids) != 1:
            return {}
        flow = max((self.bids[0] - self.offers[0] - self.freight) / (self.rise + self.fall), 0.0)
        return {"flows": np.array([[flow]]), "trade": flow}

    def draw(self, solution: Any, axes: Any) -> None:
        """Producers on the left, markets on the right, and what goes between."""
        found = self.answer(solution)
        widest = max(float(found["flows"].max()), 1e-300)
        for i, row in enumerate(found["flows"]):
            for j, flow in enumerate(row):
                if flow > 0.0:
                    axes.plot([0.0, 1.0], [-i, -j], color="#0072B2", linewidth=8.0 * flow / widest, alpha=0.7)
                    axes.text(0.3, -0.7 * i - 0.3 * j, f"{flow:.3g}", backgroundcolor="white", ha="center", va="center")
        for x, prices, side in ((0.0, found["offers"], "right"), (1.0, found["bids"], "left")):
            for i, price in enumerate(prices):
                axes.text(x + (-0.03 if side == "right" else 0.03), -i, f"{price:.3g}", ha=side, va="center")
            axes.plot(np.full(prices.size, x), -np.arange(prices.size), "ko")
        axes.set(xlim=(-0.25, 1.25), xticks=[0.0, 1.0], yticks=[])
        axes.set_xticklabels(["producers", "markets"])
        axes.set_title("flows (units), and prices at both ends (money a unit)", fontsize="medium")
