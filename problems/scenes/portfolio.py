"""Markowitz' portfolio, with bounds, and its frontier."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import NOT_NEGATIVE, number
from continuation.arrays import Array
from continuation.path import Path
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program, from_qp
from problems.lcp.parametric.along import along
from problems.scenes.rivals import CLARABEL, PIQP
from problems.scenes.scene import Quantities, Rival, Units, Unknown, numbers


def critical_line(mean: Array, covariance: Array) -> Path:
    """Markowitz' critical line: min x'Sx/2 - t m'x, x >= 0, e'x = 1, from the best asset alone to least variance.

    The path is one of weights, and of the multiplier of the budget.

    References
    ----------
    Markowitz, Naval Research Logistics Quarterly 3 (1956).
    """
    n = mean.size
    e = np.ones(n)
    A = np.block([[covariance, -e[:, None]], [e[None], np.zeros((1, 1))]])
    problem = MixedLCP(A, np.append(np.zeros(n), -1.0), np.append(np.zeros(n), -np.inf))
    best = int(np.argmax(mean))
    x = np.eye(n)[best]
    gap = np.delete(mean[best] - mean, best)
    # From there on the best asset alone is the solution.
    first = 1.1 * float((np.delete(covariance[best, best] - covariance[:, best], best) / gap).max(initial=0.0)) + 1e-3
    multiplier = covariance[best, best] - first * mean[best]
    return along(problem, np.append(-mean, 0.0), (first, 0.0), x=np.append(x, multiplier))


@frozen
class Portfolio:
    """Money to be divided among assets, none sold short: how much into each?

    min variance / 2 - tolerance * mean.

    Parameters
    ----------
    means : sequence of float
        Returns, of each asset.
    variances : sequence of float
        Of these.
    correlation : float
        Between any two of them.
    tolerance : float
        Of risk: how much variance a unit of return is worth.
    cap : float
        The largest part that one asset may have.

    References
    ----------
    Markowitz, J. Finance 7 (1952).
    """

    means: tuple[float, ...] = numbers("means", (0.12, 0.10, 0.07, 0.03))
    variances: tuple[float, ...] = numbers("variances", (0.04, 0.09, 0.16, 0.01))
    correlation: float = field(default=0.0, validator=number("a number from 0 to below 1", lambda c: 0.0 <= c < 1.0))
    tolerance: float = field(default=0.5, validator=NOT_NEGATIVE)
    cap: float = field(default=1.0, validator=number("a number above 0, at most 1", lambda c: 0.0 < c <= 1.0))
    units: ClassVar[Units] = {"weights": "", "mean": "", "deviation": ""}
    rivals: ClassVar[tuple[Rival, ...]] = (PIQP, CLARABEL)

    def __attrs_post_init__(self) -> None:
        found = len(self.variances)
        if found != len(self.means):
            raise ValueError(f"variances: expected {len(self.means)} numbers, one a mean, found {found}")

    @property
    def covariance(self) -> Array:
        """Shape (n, n)."""
        deviation = np.sqrt(self.variances)
        n = deviation.size
        return np.outer(deviation, deviation) * (self.correlation + (1.0 - self.correlation) * np.eye(n))

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """A cap is a bound: it needs no multiplier, and where it is 1 it holds by itself."""
        return (
            Unknown("weights", len(self.means), "how much of each asset"),
            Unknown("multiplier of the budget", 1, "all money is invested"),
        )

    def problem(self) -> Program:
        """At the tolerance of risk."""
        n = len(self.means)
        upper = None if self.cap == 1.0 else self.cap
        gain = -self.tolerance * np.array(self.means)
        return from_qp(self.covariance, gain, A_eq=np.ones((1, n)), b_eq=[1.0], lower=0.0, upper=upper)

    def frontier(self) -> Path:
        """All tolerances, from the best asset alone to the least variance; without the cap."""
        return critical_line(np.array(self.means), self.covariance)

    def answer(self, solution: Any) -> Quantities:
        """Weights, and what they lead to."""
        weights = np.asarray(solution.x)[: len(self.means)]
        return {
            "weights": weights, "mean": float(weights @ self.means),
            "deviation": float(np.sqrt(weights @ self.covariance @ weights)),
        }  # fmt: skip

    def exact(self) -> Quantities:
        """Without correlation and cap: (tolerance m_i + nu)_+ / s_i, nu by sorting as for a simplex."""
        if self.correlation or self.cap < 1.0:
            return {}
        gain, s = self.tolerance * np.array(self.means), np.array(self.variances)
        order = np.argsort(-gain)
        nu = (1.0 - np.cumsum(gain[order] / s[order])) / np.cumsum(1.0 / s[order])
        # With too few or too many assets the sum at that nu is above 1 with the right ones.
        return {"weights": np.maximum(gain + float(nu.min()), 0.0) / s}

    def draw(self, solution: Any, axes: Any) -> None:
        """The frontier with its kinks, the assets, and this portfolio."""
        line, n, m = self.frontier(), len(self.means), np.array(self.means)
        fine = line(np.linspace(0.0, line.arclength[-1], 300))[:, :n]
        corners = np.array([kink.y[:n] for kink in line.kinks]).reshape(-1, n)
        for weights, style, label in ((fine, "-", "frontier"), (corners, "kD", "an asset enters or leaves")):
            risk = np.sqrt(np.einsum("ki,ij,kj->k", weights, self.covariance, weights))
            axes.plot(risk, weights @ m, style, markersize=4, label=label)
        axes.plot(np.sqrt(self.variances), m, "x", color="#009E73", label="assets")
        found = self.answer(solution)
        axes.plot(found["deviation"], found["mean"], "o", color="#D55E00", label="this portfolio")
        axes.set(xlabel="standard deviation", ylabel="mean")
        axes.legend(frameon=False, fontsize="small")
