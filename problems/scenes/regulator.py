"""A regulator with a limited drive: explicit predictive control."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen
from scipy.linalg import solve_discrete_are

from continuation.arguments.checks import FINITE, integer
from continuation.arrays import Array
from continuation.path import Path
from problems.lcp.data.problem import MixedLCP
from problems.lcp.parametric.along import along
from problems.scenes.rivals import GAUSS_SEIDEL, QUADRATIC
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Regulator:
    """A cart is brought to rest by a drive of limited force: which force now, for every distance it starts from?

    The best forces over a horizon are piecewise affine in the state at the start. Their path along one line of states
    has a kink wherever a force reaches its limit or leaves it; there the value function's second derivative jumps.

    Parameters
    ----------
    distance : float
        m, of the cart at the start, which is at rest; where the answer gives the force.
    limit : float
        N, of the drive.
    mass : float
        kg.
    step : float
        s.
    weight : float
        Of a force squared, against a distance squared.
    horizon : int
        Steps.

    References
    ----------
    Bemporad, Morari, Dua and Pistikopoulos, Automatica 38 (2002).
    """

    distance: float = field(default=3.0, validator=FINITE)
    limit: float = positive(1.0)
    mass: float = positive(1.0)
    step: float = positive(0.5)
    weight: float = positive(0.1)
    horizon: int = field(default=12, validator=integer(1))
    units: ClassVar[Units] = {"force": "N", "value": "", "free up to": "m", "kinks at": "m"}
    rivals: ClassVar[tuple[Rival, ...]] = (GAUSS_SEIDEL, *QUADRATIC)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Forces; states follow from them, limits are bounds."""
        return (Unknown("forces", self.horizon, "what the drive does, now and later"),)

    def _model(self) -> tuple[Array, Array, Array, Array]:
        """Of x' = F x + G u: F, G, the weights of states, and of the last one (the value without limits)."""
        F, G = np.array([[1.0, self.step], [0.0, 1.0]]), np.array([[0.5 * self.step**2], [self.step]]) / self.mass
        Q = np.diag([1.0, 0.0])
        return F, G, Q, solve_discrete_are(F, G, Q, np.array([[self.weight]]))

    def _condensed(self) -> tuple[Array, Array, float]:
        """Min u'Hu / 2 + t f'u + t^2 c, t the distance."""
        F, G, Q, last = self._model()
        start, H = np.array([1.0, 0.0]), self.weight * np.eye(self.horizon)
        f, c, reach = np.zeros(self.horizon), 0.0, np.zeros((2, self.horizon))
        for k in range(self.horizon):
            c += 0.5 * start @ Q @ start
            reach, start = F @ reach, F @ start
            reach[:, k] += G[:, 0]
            W = last if k == self.horizon - 1 else Q
            H, f = H + reach.T @ W @ reach, f + reach.T @ W @ start
        # The first state's weight is in c once, the last state's beside it.
        return 0.5 * (H + H.T), f, float(c + 0.5 * start @ last @ start)

    def problem(self) -> MixedLCP:
        """At the distance."""
        H, f, _ = self._condensed()
        bound = np.full(self.horizon, self.limit)
        return MixedLCP(H, self.distance * f, -bound, bound)

    def solve(self) -> Path:
        """The forces for all distances from zero to twice that of the scene."""
        H, f, _ = self._condensed()
        bound = np.full(self.horizon, self.limit)
        far = 2.0 * self.distance or 1.0
        return along(MixedLCP(H, np.zeros(self.horizon), -bound, bound), f, (0.0, far), x=np.zeros(self.horizon))

    def answer(self, solution: Any) -> Quantities:
        """The force now and the value, at the distance; distances at which forces meet or leave their limits."""
        H, f, c = self._condensed()
        path = isinstance(solution, Path)
        u = solution(t=self.distance)[:-1] if path else np.asarray(solution.x)
        t = self.distance
        found = {"force": float(u[0]), "value": float(0.5 * u @ H @ u + t * f @ u + t * t * c)}
        if not path:
            return found
        kinks = np.array([kink.lam for kink in solution.kinks])
        return {**found, "free up to": float(kinks[0]) if kinks.size else float(solution.lam[-1]), "kinks at": kinks}

    def exact(self) -> Quantities:
        """Before the first kink that of Riccati's equation, which has no limits."""
        F, G, _, last = self._model()
        gain = np.linalg.solve(self.weight + G.T @ last @ G, G.T @ last @ F)[0]
        # The largest force of the closed loop says how far that holds.
        state, largest = np.array([1.0, 0.0]), 0.0
        for _ in range(self.horizon):
            u = -float(gain @ state)
            state, largest = F @ state + G[:, 0] * u, max(largest, abs(u))
        free = self.limit / largest
        known = {"free up to": free}
        if abs(self.distance) > free:
            return known if 2.0 * abs(self.distance) > free else {}
        value = 0.5 * self.distance**2 * last[0, 0]
        return {"force": -float(gain[0]) * self.distance, "value": value} if 2.0 * abs(self.distance) <= free else {
            **known, "force": -float(gain[0]) * self.distance, "value": value}  # fmt: skip

    def draw(self, solution: Any, axes: Any) -> None:
        """The first three forces against the distance, with all kinks."""
        for k in range(min(3, self.horizon)):
            axes.plot(solution.lam, solution.y[:, k], label=("now", "a step later", "two steps later")[k])
        for kink in solution.kinks:
            axes.axvline(kink.lam, color="0.85", linewidth=0.8, zorder=0)
        axes.set(xlabel="distance (m)", ylabel="force (N)")
        axes.legend(frameon=False)
