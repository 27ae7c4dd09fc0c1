"""Markowitz' portfolio and frontier."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import expect, number
from continuation.arrays import Array
from continuation.path import Path
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program, from_qp
from problems.lcp.parametric.along import along
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import PIQP
from problems.scenes.scene import NotNegative, Numbers, Quantities, Scene, Unknown, with_parameters


def critical_line(mean: Array, covariance: Array) -> Path:
    """Critical line: min x'Sx/2 - t m'x, x >= 0, e'x = 1; points are (weights, budget multiplier).

    References
    ----------
    Markowitz, Naval Research Logistics Quarterly 3 (1956).
    """
    n = mean.size
    e = np.ones(n)
    A = np.block([[covariance, -e[:, None]], [e[None], np.zeros((1, 1))]])
    problem = MixedLCP(A, np.append(np.zeros(n), -1.0), np.append(np.zeros(n), -np.inf))
    best = int(np.argmax(mean))
    gap = np.delete(mean[best] - mean, best)
    first = 1.1 * float((np.delete(covariance[best, best] - covariance[:, best], best) / gap).max(initial=0.0)) + 1e-3
    multiplier = covariance[best, best] - first * mean[best]
    return along(problem, np.append(-mean, 0.0), (first, 0.0), x=np.append(np.eye(n)[best], multiplier))


@with_parameters
def Portfolio(
    means: Numbers = (0.12, 0.10, 0.07, 0.03), variances: Numbers = (0.04, 0.09, 0.16, 0.01),
    correlation: Annotated[float, number("a number from 0 to below 1", lambda c: 0.0 <= c < 1.0)] = 0.0,
    tolerance: NotNegative = 0.5,
    cap: Annotated[float, number("a number above 0, at most 1", lambda c: 0.0 < c <= 1.0)] = 1.0,
) -> Scene:  # fmt: skip
    """How is money divided among assets, none sold short?

    Minimise variance / 2 - tolerance * mean.

    Parameters
    ----------
    means, variances : sequence of float
        Means and variances of the returns.
    correlation : float
        Correlation of any two assets.
    tolerance : float
        Risk tolerance: variance per unit of return.
    cap : float
        Largest weight.

    References
    ----------
    Markowitz, J. Finance 7 (1952).
    """
    n, m, s = len(means), np.array(means), np.array(variances)
    expect(s.size == n, "variances", f"{n} numbers, one a mean", s.size)
    deviation = np.sqrt(s)
    covariance = np.outer(deviation, deviation) * (correlation + (1.0 - correlation) * np.eye(n))

    def problem() -> Program:
        upper = None if cap == 1.0 else cap
        return from_qp(covariance, -tolerance * m, A_eq=np.ones((1, n)), b_eq=[1.0], lower=0.0, upper=upper)

    def answer(solution: Any) -> Quantities:
        weights = np.asarray(solution.x)[:n]
        risk = float(np.sqrt(weights @ covariance @ weights))
        return {"weights": weights, "mean": float(weights @ means), "deviation": risk}

    def exact() -> Quantities:
        """Without correlation and cap: (tolerance m_i + nu)_+ / s_i, nu from sorting."""
        if correlation or cap < 1.0:
            return {}
        gain = tolerance * m
        order = np.argsort(-gain)
        nu = (1.0 - np.cumsum(gain[order] / s[order])) / np.cumsum(1.0 / s[order])
        return {"weights": np.maximum(gain + float(nu.min()), 0.0) / s}

    def drawn(solution: Any) -> Picture:
        line, found = critical_line(m, covariance), answer(solution)

        def shown(weights: Array, style: str, label: str) -> Any:
            risk = np.sqrt(np.einsum("ki,ij,kj->k", weights, covariance, weights))
            return mark("plot", risk, weights @ m, style, markersize=4, label=label)

        return picture(
            shown(line(np.linspace(0.0, line.arclength[-1], 300))[:, :n], "-", "frontier"),
            shown(np.array([kink.y[:n] for kink in line.kinks]).reshape(-1, n), "kD", "an asset enters or leaves"),
            mark("plot", deviation, m, "x", color="#009E73", label="assets"),
            mark("plot", found["deviation"], found["mean"], "o", color="#D55E00", label="this portfolio"),
            xlabel="standard deviation", ylabel="mean", legend={"fontsize": "small"},
        )  # fmt: skip

    return Scene(
        units={"weights": "", "mean": "", "deviation": ""},
        unknowns=(
            Unknown("weights", n, "how much of each asset"),
            Unknown("multiplier of the budget", 1, "all money is invested"),
        ),
        problem=problem, answer=answer, exact=exact, picture=drawn, rivals=(PIQP,),
    )  # fmt: skip
