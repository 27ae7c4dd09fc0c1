"""An American put: its price, and when to exercise it."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, log, sqrt
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

from continuation.arguments.checks import NOT_NEGATIVE, integer
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.search.outcome import Solution
from problems.lcp.search.solver import solve
from problems.scenes.scene import Point, Quantities, Rival, Units, Unknown, positive

KNOWN = {
    (100.0, 100.0, 0.05, 0.2, 1.0): 6.09037,
    (36.0, 40.0, 0.06, 0.2, 1.0): 4.48668,
    (44.0, 40.0, 0.06, 0.4, 2.0): 5.64674,
}
"""Price by spot, strike, rate, volatility and maturity: binomial trees of 1000 to 8000 steps, extrapolated, by two
rules (Broadie and Detemple; Leisen and Reimer) that agree to 1e-5. The published 6.0905, 4.4867 and 5.6470 are of
trees that are not extrapolated: the mean of Cox, Ross and Rubinstein's with 3000 and 3001 steps has these digits."""


@frozen(eq=False)
class Exercise:
    """Prices of the put on the grid at expiry's beginning, and the asset's price below which to exercise, over time."""

    prices: Array
    time_left: Array
    boundary: Array
    success: bool


@frozen
class AmericanPut:
    """A put that may be exercised at any time: what is it worth, and below which price is it exercised?

    The equation of Black and Scholes in the logarithm of the price, by second-order differences, and the method of
    Crank and Nicolson after four implicit half steps (Rannacher). The steps grow linearly from expiry, where the price
    of exercise moves like a root of the time: with equal ones the order is lower (Forsyth and Vetzal). Each is a
    complementarity problem, solved from the active set of the one before.

    Parameters
    ----------
    spot, strike : float
    rate : float
        A year.
    volatility : float
        A root of a year.
    maturity : float
        Years.
    n : int
        Points of the grid.
    steps : int
        In time.
    width : float
        Of the grid to each side of the strike, in standard deviations at maturity.

    References
    ----------
    Brennan and Schwartz, J. Finance 32 (1977); Forsyth and Vetzal, SIAM J. Sci. Comput. 23 (2002); Longstaff
    and Schwartz, Rev. Financial Studies 14 (2001).
    """

    spot: float = positive(100.0)
    strike: float = positive(100.0)
    rate: float = field(default=0.05, validator=NOT_NEGATIVE)
    volatility: float = positive(0.2)
    maturity: float = positive(1.0)
    n: int = field(default=400, validator=integer(10))
    steps: int = field(default=100, validator=integer(2))
    width: float = positive(5.0)
    units: ClassVar[Units] = {"price": "money", "delta": "", "exercise below": "money"}

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """What the put is worth beyond its payoff: zero is where it is exercised."""
        return (Unknown("values above the payoff", self.n, "where to exercise, and the price elsewhere"),)

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """The elimination of the field."""
        return (Rival("Brennan-Schwartz", "", lambda scene: scene.answer(scene._march(_eliminated))),)

    @property
    def _reach(self) -> float:
        return self.width * self.volatility * sqrt(self.maturity)

    def grid(self) -> Array:
        """Logarithms of prices over the strike, both ends included, shape (n + 2,)."""
        return np.linspace(-self._reach, self._reach, self.n + 2)

    def implicit(self, step: float) -> tuple[Array, Array, Array]:
        """The diagonals of one implicit step: below, main and above, shapes (n,).

        Parameters
        ----------
        step : float
            Years.
        """
        h = 2.0 * self._reach / (self.n + 1)
        a, b = 0.5 * self.volatility**2 / h**2, (self.rate - 0.5 * self.volatility**2) / (2.0 * h)
        one = np.ones(self.n)
        return -step * (a - b) * one, (1.0 + step * (2.0 * a + self.rate)) * one, -step * (a + b) * one

    def _matrix(self, step: float) -> Any:
        below, main, above = self.implicit(step)
        return sp.diags_array([below[1:], main, above[:-1]], offsets=[-1, 0, 1], format="csr")

    @property
    def _payoff(self) -> Array:
        return self.strike * np.maximum(1.0 - np.exp(self.grid()), 0.0)

    def _lifted(self, step: float, values: Array) -> Array:
        """The implicit matrix times values at all points, inner and boundary."""
        below, main, above = self.implicit(step)
        return below * values[:-2] + main * values[1:-1] + above * values[2:]

    def problem(self) -> LCP:
        """The last time step before expiry, the first one that is solved."""
        step = 0.5 * self.maturity / self.steps**2
        return LCP(self._matrix(step), self._lifted(step, self._payoff) - self._payoff[1:-1])

    def solve(self) -> Exercise:
        """All time steps."""
        found: Solution | None = None

        def step(problem: LCP) -> Solution:
            nonlocal found
            found = solve(problem, guess=found)
            return found

        return self._march(step)

    def _march(self, solver: Callable[[LCP], Any]) -> Exercise:
        """Back from expiry, by any solver of a time step."""
        payoff, x = self._payoff, self.grid()
        times = self.maturity * (np.arange(self.steps + 1) / self.steps) ** 2
        # Four half steps, implicit: the payoff's kink makes Crank and Nicolson's method oscillate.
        times = np.concatenate([[0.0, 0.5 * times[1]], [times[1], 0.5 * (times[1] + times[2])], times[2:]])
        values, edges, well = payoff.copy(), [self.strike], True
        for k, dt in enumerate(np.diff(times)):
            implicit = dt if k < 4 else 0.5 * dt
            known = values[1:-1] if k < 4 else 2.0 * values[1:-1] - self._lifted(implicit, values)
            found = solver(LCP(self._matrix(implicit), self._lifted(implicit, payoff) - known))
            well = bool(found.success) and found.x is not None
            if not well:
                break
            values[1:-1] = payoff[1:-1] + found.x
            # With more time left it is exercised at no higher price; in the first steps the mesh is too coarse to tell.
            edges.append(min(self._edge(found.x, x), edges[-1]))
        return Exercise(values, times[: len(edges)], np.array(edges), well)

    def _edge(self, above: Array, x: Array) -> float:
        """Where the value leaves the payoff: as a square, from the second and the fourth point where it does.

        The first one has the error of an equation across the edge; without it the boundary is seven times as smooth.
        """
        beyond = above > 1e-12 * self.strike
        k = int(np.argmax(beyond)) if beyond.any() else 0
        second, fourth = np.sqrt(above[k + 1 : k + 4 : 2]) if k + 4 <= above.size else (0.0, 0.0)
        away = min(max(2.0 * second / (fourth - second) - 1.0, 0.0), 1.5) if fourth > second else 0.0
        return self.strike * exp(float(x[k + 1] - away * (x[1] - x[0])))

    def answer(self, solution: Any) -> Quantities:
        """By a cubic through the four points around the spot, which keeps the second order of the differences."""
        x, place = self.grid(), log(self.spot / self.strike)
        k = min(max(int(np.searchsorted(x, place)), 2), x.size - 2)
        cubic = np.polynomial.Polynomial.fit(x[k - 2 : k + 2], solution.prices[k - 2 : k + 2], 3)
        return {
            "price": float(cubic(place)), "delta": float(cubic.deriv()(place)) / self.spot,
            "exercise below": float(solution.boundary[-1]),
        }  # fmt: skip

    def exact(self) -> Quantities:
        """For the cases of the tables."""
        key = (self.spot, self.strike, self.rate, self.volatility, self.maturity)
        return {"price": KNOWN[key]} if key in KNOWN else {}

    def draw(self, solution: Any, axes: Any) -> None:
        """The price below which to exercise, against the time that is left."""
        axes.plot(solution.time_left, solution.boundary, color="#0072B2")
        axes.fill_between(solution.time_left, 0.0, solution.boundary, color="#0072B2", alpha=0.12, label="exercise")
        axes.plot(self.maturity, self.spot, "o", color="#D55E00", label=f"price {self.answer(solution)['price']:.4f}")
        low = min(solution.boundary.min(), self.spot)
        axes.set(
            xlabel="time left (years)",
            ylabel="price of the asset (money)",
            ylim=(0.9 * low, 1.1 * max(self.strike, self.spot)),
        )
        axes.legend(frameon=False)


def _eliminated(problem: LCP) -> Point:
    """Brennan and Schwartz' elimination for a tridiagonal matrix: exact where the put is exercised below one price.

    Eliminated from above, substituted from below with the positive part taken at each point: that takes a loop.
    """
    A: Any = problem.A
    lower, main, upper, right = (part.tolist() for part in (A.diagonal(-1), A.diagonal(), A.diagonal(1), -problem.q))
    for i in range(len(main) - 2, -1, -1):
        factor = upper[i] / main[i + 1]
        main[i] -= factor * lower[i]
        right[i] -= factor * right[i + 1]
    x = [max(right[0] / main[0], 0.0)]
    for i in range(1, len(main)):
        x.append(max((right[i] - lower[i - 1] * x[-1]) / main[i], 0.0))
    return Point(np.array(x))
