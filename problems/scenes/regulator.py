"""Explicit predictive control of a limited drive."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from scipy.linalg import solve_discrete_are

from continuation.arguments.checks import integer
from problems.lcp.data.problem import MixedLCP
from problems.lcp.parametric.along import along
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import Finite, Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Regulator(
    distance: Finite = 3.0, limit: Positive = 1.0, mass: Positive = 1.0, step: Positive = 0.5,
    weight: Positive = 0.1, horizon: Annotated[int, integer(1)] = 12,
) -> Scene:  # fmt: skip
    """Which limited force best brings a cart to rest from each distance?

    The path of the best forces has a kink where a force reaches or leaves its limit.

    Parameters
    ----------
    distance : float
        m, from rest, where the force is reported.
    limit, mass, step : float
        N, kg, s.
    weight : float
        Weight of squared force relative to squared distance.
    horizon : int
        Steps.

    References
    ----------
    Bemporad, Morari, Dua and Pistikopoulos, Automatica 38 (2002).
    """
    # x' = F x + G u; `last` weighs the final state.
    F, G = np.array([[1.0, step], [0.0, 1.0]]), np.array([[0.5 * step**2], [step]]) / mass
    Q = np.diag([1.0, 0.0])
    last = solve_discrete_are(F, G, Q, np.array([[weight]]))
    state, H = np.array([1.0, 0.0]), weight * np.eye(horizon)
    f, c, reach = np.zeros(horizon), 0.0, np.zeros((2, horizon))
    for k in range(horizon):
        c += 0.5 * state @ Q @ state
        reach, state = F @ reach, F @ state
        reach[:, k] += G[:, 0]
        W = last if k == horizon - 1 else Q
        H, f = H + reach.T @ W @ reach, f + reach.T @ W @ state
    H, c = 0.5 * (H + H.T), float(c + 0.5 * state @ last @ state)
    bound, none = np.full(horizon, limit), np.zeros(horizon)

    def answer(solution: Any) -> Quantities:
        t, kinks = distance, np.array([kink.lam for kink in solution.kinks])
        u = solution(t=t)[:-1]
        return {
            "force": float(u[0]), "value": float(0.5 * u @ H @ u + t * f @ u + t * t * c),
            "free up to": float(kinks[0]) if kinks.size else float(solution.lam[-1]), "kinks at": kinks,
        }  # fmt: skip

    def exact() -> Quantities:
        """The Riccati solution holds before the first kink."""
        gain = np.linalg.solve(weight + G.T @ last @ G, G.T @ last @ F)[0]
        state, largest = np.array([1.0, 0.0]), 0.0
        for _ in range(horizon):
            u = -float(gain @ state)
            state, largest = F @ state + G[:, 0] * u, max(largest, abs(u))
        free, far = limit / largest, abs(distance)
        near = {"force": -float(gain[0]) * distance, "value": 0.5 * distance**2 * last[0, 0]} if far <= free else {}
        return {"free up to": free, **near} if 2.0 * far > free else near

    def drawn(solution: Any) -> Picture:
        first = zip(solution.y.T, ("now", "a step later", "two steps later"))
        return picture(
            *(mark("plot", solution.lam, force, label=label) for force, label in first),
            *(mark("axvline", kink.lam, color="0.85", linewidth=0.8, zorder=0) for kink in solution.kinks),
            xlabel="distance (m)", ylabel="force (N)",
        )  # fmt: skip

    return Scene(
        units={"force": "N", "value": "", "free up to": "m", "kinks at": "m"},
        unknowns=(Unknown("forces", horizon, "what the drive does, now and later"),),
        problem=lambda: MixedLCP(H, distance * f, -bound, bound),
        answer=answer, exact=exact, picture=drawn,
        solve=lambda: along(MixedLCP(H, none, -bound, bound), f, (0.0, 2.0 * distance or 1.0), x=none),
    )  # fmt: skip
