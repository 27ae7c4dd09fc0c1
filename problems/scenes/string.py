"""A string that hangs over a floor: where it lies on it."""

from __future__ import annotations

from math import sqrt
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

from continuation.arguments.checks import integer
from problems.lcp.data.problem import LCP
from problems.scenes.rivals import BFGS, CLARABEL, GAUSS_SEIDEL, LEMKE, PIQP
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class String:
    """A heavy string between two supports above a floor: where does it touch down?

    By second-order differences, T u'' = load where it hangs. By symmetry half of it is modelled.

    Parameters
    ----------
    height : float
        m, of the supports above the floor.
    load : float
        N/m.
    tension : float
        N.
    length : float
        m, between the supports.
    n : int
        Points from a support, which is none of them, to the middle.
    """

    height: float = positive(0.05)
    load: float = positive(1.0)
    tension: float = positive(1.0)
    length: float = positive(1.0)
    n: int = field(default=50, validator=integer(2))
    units: ClassVar[Units] = {"contact from": "m", "support force": "N", "floor force": "N"}
    rivals: ClassVar[tuple[Rival, ...]] = (GAUSS_SEIDEL, LEMKE, PIQP, CLARABEL, BFGS)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Heights; the force of the floor is what balances a point, and needs no unknown."""
        return (Unknown("heights above the floor", self.n, "where the string hangs and where it lies"),)

    @property
    def h(self) -> float:
        """The distance of two points."""
        return 0.5 * self.length / self.n

    def problem(self) -> LCP:
        """Forces on the points; on the middle, that of one half."""
        k = self.tension / self.h
        main = np.full(self.n, 2.0 * k)
        main[-1] = k
        side = np.full(self.n - 1, -k)
        q = np.full(self.n, self.load * self.h)
        q[-1] *= 0.5
        q[0] -= k * self.height
        return LCP(sp.diags_array([side, main, side], offsets=[-1, 0, 1], format="csr"), q)

    def answer(self, solution: Any) -> Quantities:
        """A support bears what hangs from it: its force tells where the string touches down, to second order."""
        support = self.tension * (self.height - float(solution.x[0])) / self.h + 0.5 * self.load * self.h
        return {
            "contact from": support / self.load, "support force": support,
            "floor force": self.load * self.length - 2.0 * support,
        }  # fmt: skip

    def exact(self) -> Quantities:
        """A parabola that is tangent to the floor at sqrt(2 T height / load), or one that is above it."""
        a = min(sqrt(2.0 * self.tension * self.height / self.load), 0.5 * self.length)
        force = self.load * a
        return {"contact from": a, "support force": force, "floor force": self.load * self.length - 2.0 * force}

    def draw(self, solution: Any, axes: Any) -> None:
        """The string, both halves."""
        half = np.concatenate([[self.height], solution.x])
        axes.plot(np.linspace(0.0, self.length, 2 * self.n + 1), np.concatenate([half, half[-2::-1]]), color="#0072B2")
        a = self.answer(solution)["contact from"]
        axes.plot([a, self.length - a], [0.0, 0.0], "kD", markersize=4, label=f"contact from {a:.4f} m")
        axes.axhline(0.0, color="0.4", linewidth=0.8, zorder=0)
        axes.set(xlabel="m from the left support", ylabel="height (m)")
        axes.legend(frameon=False)
