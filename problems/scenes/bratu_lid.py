"""A reacting layer under a lid: Bratu's fold, and the kink behind it."""

from __future__ import annotations

from math import acosh, exp, sqrt
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen
from scipy.optimize import brentq

from continuation.arguments.checks import integer
from continuation.arrays import Array
from continuation.linear import Banded
from continuation.tracing import solve_at
from problems.bifurcation import Bratu1D
from problems.nonlinear.normal_map import NormalMap
from problems.nonlinear.obstacle import BratuForce
from problems.scenes.arc_length import arc_length_method
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class HalfLayer:
    """The force of `BratuForce` at the points of one half, the last one in the middle, for a solution that is even."""

    n: int

    @property
    def _whole(self) -> BratuForce:
        return BratuForce(Bratu1D(2 * self.n - 1))

    def __call__(self, x: Any, lam: Any) -> Any:
        """The value, shape (n,); jets pass through it."""
        return self._whole(np.concatenate((x, x[-2::-1])), lam)[: self.n]

    def slope(self, x: Array, lam: float) -> tuple[Banded, Array]:
        """Tridiagonal, and shape (n,)."""
        F_x, F_lam = self._whole.slope(np.concatenate((x, x[-2::-1])), lam)
        bands = F_x.ab[:, : self.n].copy()
        # Of the middle both neighbours are the same unknown.
        bands[2, -2] *= 2.0
        return Banded(bands, 1, 1), F_lam[: self.n]


@frozen
class BratuLid:
    """A layer that heats itself, u'' + load e^u = 0, with u held below a lid: where does its path turn?

    Its path turns in the usual fold, comes back until the middle touches the lid, and turns there again, in a kink. By
    second-order differences; solutions are symmetric, so half the layer is modelled.

    Parameters
    ----------
    lid : float
        More than 1.1869, the largest u in the fold: below that there is none.
    load : float
        At which the answer says where u touches the lid.
    n : int
        Points from the surface, which is none of them, to the middle.

    References
    ----------
    Bratu, Bull. Soc. Math. France 42 (1914).
    """

    lid: float = positive(2.0)
    load: float = positive(6.0)
    n: int = field(default=50, validator=integer(4))
    units: ClassVar[Units] = {"fold": "", "turning kink": "", "contact from": ""}

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """One half: with both, kinks would come in pairs."""
        return (Unknown("temperatures", self.n, "where they reach the lid"),)

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """What finite element programs do; loads one after another, by `scipy.optimize.root`, end at the fold."""
        named = BratuLid._named
        return (arc_length_method(BratuLid._load, lambda scene, at: named(scene, at.fold, at.kink, at.z)),)

    def problem(self) -> NormalMap:
        """The path from zero load, to the load."""
        layer = HalfLayer(self.n)
        return NormalMap(layer, layer.slope, x0=np.zeros(self.n), lam0=0.0, lower=-np.inf, upper=self.lid,
                         target=max(self.load, 3.6))  # fmt: skip

    def answer(self, solution: Any) -> Quantities:
        """Loads at which the path turns, and the contact's edge at the load."""
        folds = [event.lam for event in solution.turning_points if event not in solution.kinks]
        kinks = [kink.lam for kink in solution.kinks if kink.name == "turning kink"]
        z = solve_at(self.problem(), self.load, solution.crossings(self.load)[-1][:-1])
        return self._named(folds[0] if folds else np.nan, kinks[0] if kinks else np.nan, z)

    def _load(self) -> float:
        return self.load

    def _named(self, fold: float, kink: float, z: Array) -> Quantities:
        # z is above the lid by the lid's force; where u rests that is the load's, so it tells how far: to second order.
        force = np.maximum(z - self.lid, 0.0) * np.append(np.ones(self.n - 1), 0.5) * 2.0 * self.n
        edge = 0.5 - float(force.sum()) / (self.load * exp(self.lid))
        return {"fold": fold, "turning kink": kink, "contact from": edge}

    def exact(self) -> Quantities:
        """By quadrature: u' = 0 at the lid's edge, so that all is in elementary functions."""
        turn = float(brentq(lambda z: z * np.tanh(z) - 1.0, 1.0, 1.5, xtol=1e-15))
        reach = acosh(exp(0.5 * self.lid))
        return {
            "fold": 8.0 * turn**2 / np.cosh(turn) ** 2, "turning kink": 8.0 * exp(-self.lid) * reach**2,
            "contact from": min(sqrt(2.0 / self.load) * exp(-0.5 * self.lid) * reach, 0.5),
        }  # fmt: skip

    def draw(self, solution: Any, axes: Any) -> None:
        """The mean of u against the load, with fold and kinks."""
        s = np.linspace(0.0, solution.arclength[-1], 400)
        weight = np.append(np.ones(self.n - 1), 0.5) / self.n
        mean = np.minimum(solution(s)[:, :-1], self.lid) @ weight
        axes.plot(solution(s)[:, -1], mean, color="#0072B2")
        for events, mark, label in ((solution.kinks, "kD", "kinks"), (solution.turning_points, "wo", "turns")):
            loads, means = [e.lam for e in events], [np.minimum(e.y, self.lid) @ weight for e in events]
            axes.plot(loads, means, mark, markersize=5, markeredgecolor="black", label=label)
        axes.set(xlabel="load", ylabel="mean temperature")
        axes.legend(frameon=False)
