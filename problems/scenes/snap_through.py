"""A shallow truss that snaps through, onto a stop."""

from __future__ import annotations

from math import sqrt
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import number
from continuation.arrays import Array
from problems.nonlinear.normal_map import NormalMap
from problems.scenes.arc_length import arc_length_method
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class ShallowTruss:
    """The force that two shallow bars lack of balance, upward, at a height, over stiffness rise^3 / span^3."""

    def __call__(self, x: Any, lam: Any) -> Any:
        """x^3 - x + load, shape (1,)."""
        return x**3 - x + lam

    def slope(self, x: Array, lam: float) -> tuple[Array, Array]:
        """Shapes (1, 1) and (1,)."""
        return np.diag(3.0 * x**2 - 1.0), np.ones(1)


@frozen
class SnapThrough:
    """Two shallow bars snap through under a load, onto a stop below: when, and what does the stop bear?

    The path of the height turns in a fold, comes back, and turns again in a kink, where the joint touches the stop.

    Parameters
    ----------
    rise : float
        m, of the joint above the supports.
    span : float
        m, from the joint to a support.
    stiffness : float
        N: Young's modulus times the section of a bar.
    stop : float
        Height of the stop over the rise; below 0.
    load : float
        Over the load of the fold: where the force on the stop is asked for.

    References
    ----------
    von Mises, Z. angew. Math. Mech. 3 (1923).
    """

    rise: float = positive(0.05)
    span: float = positive(1.0)
    stiffness: float = positive(1e6)
    stop: float = field(default=-0.3, validator=number("a number between -1 and 0", lambda s: -1.0 < s < 0.0))
    load: float = positive(1.5)
    units: ClassVar[Units] = {"snap load": "N", "load at touch": "N", "force on stop": "N"}

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """One, by symmetry; the force of the stop is what balances the joint."""
        return (Unknown("height of the joint", 1, "where it is when it touches the stop"),)

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """What finite element programs do; loads one after another, by `scipy.optimize.root`, end at the fold."""
        named = SnapThrough._named
        return (arc_length_method(SnapThrough._load, lambda scene, at: named(scene, at.fold, at.kink, at.z)),)

    @property
    def unit(self) -> float:
        """Of loads, N."""
        return self.stiffness * (self.rise / self.span) ** 3

    def problem(self) -> NormalMap:
        """The path of the height over the rise, from no load."""
        truss, last = ShallowTruss(), max(self.load, 1.0) * 2.0 / (3.0 * sqrt(3.0))
        return NormalMap(truss, truss.slope, x0=np.ones(1), lam0=0.0, lower=self.stop, upper=np.inf,
                         target=1.1 * last)  # fmt: skip

    def answer(self, solution: Any) -> Quantities:
        """The loads at which the path turns; beyond the second the stop bears what exceeds it."""
        (kink,) = (event.lam for event in solution.kinks)
        z = solution.crossings(self._load())[-1][:-1]
        return self._named(solution.turning_points[0].lam, kink, z)

    def _load(self) -> float:
        return self.load * 2.0 / (3.0 * sqrt(3.0))

    def _named(self, fold: float, kink: float, z: Array) -> Quantities:
        # The normal map's z is below the bound by the force that the bound bears.
        force = max(self.stop - float(z[0]), 0.0)
        return {"snap load": self.unit * fold, "load at touch": self.unit * kink, "force on stop": self.unit * force}

    def exact(self) -> Quantities:
        """The cubic's extremum, and its value at the stop."""
        fold, touch = 2.0 / (3.0 * sqrt(3.0)), self.stop - self.stop**3
        force = max(self.load * fold - touch, 0.0)
        return {"snap load": self.unit * fold, "load at touch": self.unit * touch, "force on stop": self.unit * force}

    def draw(self, solution: Any, axes: Any) -> None:
        """The load against the height."""
        u = solution(np.linspace(0.0, solution.arclength[-1], 400))
        height = self.rise * np.maximum(u[:, 0], self.stop)
        axes.plot(height, self.unit * u[:, 1], color="#0072B2")
        for events, mark, label in (
            (solution.turning_points, "wo", "fold"),
            (solution.kinks, "kD", "touches the stop"),
        ):
            loads = [self.unit * event.lam for event in events]
            heights = [self.rise * max(event.y[0], self.stop) for event in events]
            axes.plot(heights, loads, mark, markersize=6, markeredgecolor="black", label=label)
        axes.axvline(self.rise * self.stop, color="0.7", linewidth=3.0, zorder=0)
        axes.invert_xaxis()
        axes.set(xlabel="height of the joint (m)", ylabel="load (N)")
        axes.legend(frameon=False)
