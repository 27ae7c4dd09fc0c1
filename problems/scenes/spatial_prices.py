"""Spatial price equilibrium."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import LEMKE, QUADRATIC, TABLES
from problems.scenes.scene import NotNegative, Numbers, Positive, Quantities, Scene, Unknown, with_parameters


def trade(supply: tuple[Array, Array], demand: tuple[Array, Array], freight: Array) -> LCP:
    """LCP for row-major flows from m suppliers to k markets; `freight` has shape (m, k).

    `supply`, `demand`: price at zero quantity, and its rise or fall per unit.
    """
    (a, b), (c, e) = supply, demand
    out, to = np.kron(np.eye(a.size), np.ones((1, c.size))), np.kron(np.ones((1, a.size)), np.eye(c.size))
    A = out.T @ np.diag(b) @ out + to.T @ np.diag(e) @ to
    return LCP(A, out.T @ a - to.T @ c + freight.ravel())


@with_parameters
def SpatialPrices(
    offers: Numbers = (4.0, 8.0, 12.0), rise: Positive = 1.0, bids: Numbers = (14.0, 30.0, 22.0), fall: Positive = 1.0,
    freight: NotNegative = 2.0,
) -> Scene:  # fmt: skip
    """Which producers deliver to which markets, and what does the good cost there?

    Parameters
    ----------
    offers, bids : sequence of float
        Prices at which supply and demand begin.
    rise, fall : float
        Change of these per unit.
    freight : float
        From place i to j a unit costs (1 + |i - j|) times this.

    References
    ----------
    Samuelson, Amer. Econ. Review 42 (1952); Takayama and Judge, Spatial and Temporal Price and Allocation Models, 1971.
    """
    sell, buy = np.array(offers), np.array(bids)
    m, k = sell.size, buy.size
    i, j = np.indices((m, k))
    costs = freight * (1.0 + np.abs(i - j))

    def answer(solution: Any) -> Quantities:
        """Prices and trade are unique, flows are not."""
        flows = np.asarray(solution.x).reshape(m, k)
        return {
            "flows": flows, "offers": sell + rise * flows.sum(axis=1),
            "bids": buy - fall * flows.sum(axis=0), "trade": float(flows.sum()),
        }  # fmt: skip

    def exact() -> Quantities:
        flow = max((bids[0] - offers[0] - freight) / (rise + fall), 0.0)
        return {"flows": np.array([[flow]]), "trade": flow} if m == k == 1 else {}

    def drawn(solution: Any) -> Picture:
        found = answer(solution)
        flows, widest = found["flows"], max(float(found["flows"].max()), 1e-300)
        ways = [(i, j, flows[i, j]) for i, j in np.argwhere(flows > 0.0)]
        sides = ((0.0, -0.03, found["offers"], "right"), (1.0, 0.03, found["bids"], "left"))
        return picture(
            *(mark("plot", [0.0, 1.0], [-i, -j], color="#0072B2", linewidth=8.0 * flow / widest, alpha=0.7)
              for i, j, flow in ways),
            *(mark("text", 0.3, -0.7 * i - 0.3 * j, f"{flow:.3g}", backgroundcolor="white", ha="center", va="center")
              for i, j, flow in ways),
            *(mark("text", x + away, -i, f"{price:.3g}", ha=side, va="center")
              for x, away, prices, side in sides for i, price in enumerate(prices)),
            *(mark("plot", np.full(prices.size, x), -np.arange(prices.size), "ko") for x, _, prices, _ in sides),
            xlim=(-0.25, 1.25), xticks=[0.0, 1.0], xticklabels=["producers", "markets"], yticks=[],
            title="flows (units), and prices at both ends (money a unit)",
        )  # fmt: skip

    return Scene(
        units={"flows": "units", "offers": "money a unit", "bids": "money a unit", "trade": ""},
        unknowns=(Unknown("flows", m * k, "who delivers where"),),
        problem=lambda: trade((sell, np.full(m, rise)), (buy, np.full(k, fall)), costs),
        answer=answer, exact=exact, picture=drawn, rivals=(LEMKE, TABLES, *QUADRATIC),
    )  # fmt: skip
