"""Cournot's oligopoly."""

from __future__ import annotations

from math import inf
from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import POSITIVE
from problems.lcp.data.problem import MixedLCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import QUADRATIC
from problems.scenes.scene import Numbers, Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Cournot(
    costs: Numbers = (10.0, 20.0, 30.0, 80.0), intercept: Positive = 100.0, slope: Positive = 1.0,
    capacity: Annotated[float, POSITIVE] = inf,
) -> Scene:  # fmt: skip
    """How much does each of several producers with different costs sell?

    The price is intercept - slope * total.

    Parameters
    ----------
    costs : sequence of float
        Per unit.
    intercept, slope : float
    capacity : float
        Per producer.

    References
    ----------
    Cournot, Recherches sur les principes mathematiques de la theorie des richesses, 1838.
    """
    cost, n = np.array(costs), len(costs)
    A = slope * (np.eye(n) + np.ones((n, n)))

    def answer(solution: Any) -> Quantities:
        sold = np.asarray(solution.x)
        price = intercept - slope * float(sold.sum())
        return {"quantities": sold, "price": price, "profits": (price - cost) * sold}

    def exact() -> Quantities:
        """The cheapest producers enter first; a binding capacity has no closed form."""
        price = float(min(intercept, ((intercept + np.cumsum(np.sort(cost))) / (np.arange(n) + 2.0)).min()))
        sold = np.maximum(price - cost, 0.0) / slope
        return {} if (sold > capacity).any() else {"quantities": sold, "price": price}

    def drawn(solution: Any) -> Picture:
        found = answer(solution)
        return picture(
            mark("bar", range(n), found["quantities"], color="#0072B2"),
            mark("set_xticks", range(n), [f"cost {one:g}" for one in costs], fontsize="small"),
            xlabel="producer", ylabel="units sold", title=f"price {found['price']:.4g}",
        )  # fmt: skip

    return Scene(
        units={"quantities": "units", "price": "money a unit", "profits": "money"},
        unknowns=(Unknown("quantities", n, "who sells how much"),),
        problem=lambda: MixedLCP(A, cost - intercept, np.zeros(n), np.full(n, capacity)),
        answer=answer, exact=exact, picture=drawn, rivals=QUADRATIC,
    )  # fmt: skip
