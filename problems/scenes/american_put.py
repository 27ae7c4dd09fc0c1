"""An American put."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, log, sqrt
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arguments.checks import integer
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.search.solver import solve
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import (
    NotNegative,
    Positive,
    Quantities,
    Rival,
    Scene,
    Unknown,
    with_parameters,
)

KNOWN = {
    (100.0, 100.0, 0.05, 0.2, 1.0): 6.09037,
    (36.0, 40.0, 0.06, 0.2, 1.0): 4.48668,
    (44.0, 40.0, 0.06, 0.4, 2.0): 5.64674,
}
"""Price by (spot, strike, rate, volatility, maturity), from trees extrapolated by two rules (Broadie and Detemple;
Leisen and Reimer) that agree to 1e-5."""


@frozen(eq=False)
class Exercise:
    """Prices on the grid today, and the exercise boundary over time."""

    prices: Array
    time_left: Array
    boundary: Array
    success: bool


@with_parameters
def AmericanPut(
    spot: Positive = 100.0, strike: Positive = 100.0, rate: NotNegative = 0.05, volatility: Positive = 0.2,
    maturity: Positive = 1.0, n: Annotated[int, integer(10)] = 400, steps: Annotated[int, integer(2)] = 100,
    width: Positive = 5.0,
) -> Scene:  # fmt: skip
    """What is a put worth that may be exercised at any time, and below which price is it exercised?

    Crank-Nicolson follows four implicit half steps (Rannacher). Time steps grow from expiry; equal ones have a lower
    order (Forsyth and Vetzal).

    Parameters
    ----------
    spot, strike : float
    rate, volatility, maturity : float
        Per year; years.
    n, steps : int
        Grid points; time steps.
    width : float
        Half the grid, in standard deviations at maturity.

    References
    ----------
    Brennan and Schwartz, J. Finance 32 (1977); Forsyth and Vetzal, SIAM J. Sci. Comput. 23 (2002); Longstaff
    and Schwartz, Rev. Financial Studies 14 (2001).
    """
    reach = width * volatility * sqrt(maturity)
    x = np.linspace(-reach, reach, n + 2)
    payoff = strike * np.maximum(1.0 - np.exp(x), 0.0)
    h = 2.0 * reach / (n + 1)
    a, b = 0.5 * volatility**2 / h**2, (rate - 0.5 * volatility**2) / (2.0 * h)

    def implicit(step: float) -> tuple[float, float, float]:
        return -step * (a - b), 1.0 + step * (2.0 * a + rate), -step * (a + b)

    def lifted(step: float, values: Array) -> Array:
        below, main, above = implicit(step)
        return below * values[:-2] + main * values[1:-1] + above * values[2:]

    def stepped(step: float, known: Array) -> LCP:
        A = sp.diags_array(implicit(step), offsets=[-1, 0, 1], shape=(n, n), format="csr")
        return LCP(A, lifted(step, payoff) - known)

    def march(solver: Callable[[LCP, Any], Any]) -> Exercise:
        times = maturity * (np.arange(steps + 1) / steps) ** 2
        times = np.concatenate([[0.0, 0.5 * times[1]], [times[1], 0.5 * (times[1] + times[2])], times[2:]])
        values, edges = payoff.copy(), [strike]
        found: Any = None
        for k, dt in enumerate(np.diff(times)):
            step = dt if k < 4 else 0.5 * dt
            known = values[1:-1] if k < 4 else 2.0 * values[1:-1] - lifted(step, values)
            found = solver(stepped(step, known), found)
            if not found.success:
                break
            # Tiny far values lack the strike's digits.
            values[1:-1] = (strike + payoff[1:-1] + found.x) - strike
            # The boundary falls with the time left, which coarse first steps do not show.
            edges.append(min(edge(found.x), edges[-1]))
        return Exercise(values, times[: len(edges)], np.array(edges), bool(found.success))

    def edge(above: Array) -> float:
        """First price above the payoff."""
        beyond = above > 1e-12 * strike
        return strike * exp(float(x[int(np.argmax(beyond)) + 1])) if beyond.any() else strike

    def answer(solution: Any) -> Quantities:
        """A cubic keeps second order."""
        place = log(spot / strike)
        k = min(max(int(np.searchsorted(x, place)), 2), n)
        cubic = np.polynomial.Polynomial.fit(x[k - 2 : k + 2], solution.prices[k - 2 : k + 2], 3)
        return {
            "price": float(cubic(place)), "delta": float(cubic.deriv()(place)) / spot,
            "exercise below": float(solution.boundary[-1]),
        }  # fmt: skip

    def exact() -> Quantities:
        key = (spot, strike, rate, volatility, maturity)
        return {"price": KNOWN[key]} if key in KNOWN else {}

    def drawn(solution: Any) -> Picture:
        time, below = solution.time_left, solution.boundary
        return picture(
            mark("plot", time, below, color="#0072B2"),
            mark("fill_between", time, 0.0, below, color="#0072B2", alpha=0.12, label="exercise"),
            mark("plot", maturity, spot, "o", color="#D55E00", label=f"price {answer(solution)['price']:.4f}"),
            xlabel="time left (years)", ylabel="price of the asset (money)",
            ylim=(0.9 * min(below.min(), spot), 1.1 * max(strike, spot)),
        )  # fmt: skip

    return Scene(
        units={"price": "money", "delta": "", "exercise below": "money"},
        unknowns=(Unknown("values above the payoff", n, "where to exercise, and the price elsewhere"),),
        problem=lambda: stepped(0.5 * maturity / steps**2, payoff[1:-1]),
        solve=lambda: march(lambda problem, last: solve(problem, guess=last)),
        answer=answer, exact=exact, picture=drawn,
        rivals=(Rival("Brennan-Schwartz", "", lambda scene: answer(march(lambda problem, _: _eliminated(problem)))),),
    )  # fmt: skip


def _eliminated(problem: LCP) -> Any:
    """Tridiagonal elimination, exact if the put is exercised below one price."""
    A: Any = problem.A
    lower, main, upper, right = (part.tolist() for part in (A.diagonal(-1), A.diagonal(), A.diagonal(1), -problem.q))
    for i in range(len(main) - 2, -1, -1):
        factor = upper[i] / main[i + 1]
        main[i] -= factor * lower[i]
        right[i] -= factor * right[i + 1]
    x = [max(right[0] / main[0], 0.0)]
    for i in range(1, len(main)):
        x.append(max((right[i] - lower[i - 1] * x[-1]) / main[i], 0.0))
    return SimpleNamespace(x=np.array(x), success=True)
