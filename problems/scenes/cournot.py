"""Cournot's oligopoly: how much do competing producers sell?"""

from __future__ import annotations

from math import inf
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import POSITIVE
from problems.lcp.data.problem import MixedLCP
from problems.scenes.rivals import GAUSS_SEIDEL, QUADRATIC
from problems.scenes.scene import Quantities, Rival, Units, Unknown, numbers, positive


@frozen
class Cournot:
    """Producers with different costs sell one good at the price that their total leaves: who sells how much?

    The price is intercept - slope * total. Each maximises its own profit, given what the others sell.

    Parameters
    ----------
    costs : sequence of float
        Money a unit, of each producer.
    intercept : float
        The price at which nothing is bought.
    slope : float
        By which the price falls with each unit.
    capacity : float
        The most that one producer can make.

    References
    ----------
    Cournot, Recherches sur les principes mathematiques de la theorie des richesses, 1838.
    """

    costs: tuple[float, ...] = numbers("costs", (10.0, 20.0, 30.0, 80.0))
    intercept: float = positive(100.0)
    slope: float = positive(1.0)
    capacity: float = field(default=inf, validator=POSITIVE)
    units: ClassVar[Units] = {"quantities": "units", "price": "money a unit", "profits": "money"}
    rivals: ClassVar[tuple[Rival, ...]] = (GAUSS_SEIDEL, *QUADRATIC)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Quantities alone: a capacity is a bound, which needs no multiplier, and the price follows."""
        return (Unknown("quantities", len(self.costs), "who sells how much"),)

    def problem(self) -> MixedLCP:
        """Marginal profits, with their signs changed."""
        n = len(self.costs)
        A = self.slope * (np.eye(n) + np.ones((n, n)))
        return MixedLCP(A, np.array(self.costs) - self.intercept, np.zeros(n), np.full(n, self.capacity))

    def answer(self, solution: Any) -> Quantities:
        """Quantities, price and profits."""
        sold = np.asarray(solution.x)
        price = self.intercept - self.slope * float(sold.sum())
        return {"quantities": sold, "price": price, "profits": (price - np.array(self.costs)) * sold}

    def exact(self) -> Quantities:
        """Without a binding capacity: producers enter in the order of their costs as long as it pays."""
        costs = np.sort(self.costs)
        prices = (self.intercept + np.cumsum(costs)) / (np.arange(costs.size) + 2.0)
        price = float(min(self.intercept, prices.min()))
        sold = np.maximum(price - np.array(self.costs), 0.0) / self.slope
        return {} if (sold > self.capacity).any() else {"quantities": sold, "price": price}

    def draw(self, solution: Any, axes: Any) -> None:
        """What each sells, against its cost, below the price."""
        found = self.answer(solution)
        axes.bar(range(len(self.costs)), found["quantities"], color="#0072B2")
        axes.set(xlabel="producer", ylabel="units sold", xticks=range(len(self.costs)))
        axes.set_xticklabels([f"cost {cost:g}" for cost in self.costs], fontsize="small")
        axes.set_title(f"price {found['price']:.4g}", fontsize="medium")
