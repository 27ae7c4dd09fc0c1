"""A masonry arch under its own weight: does it stand?"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import integer
from continuation.arrays import Array
from problems.lcp.data.program import Program, from_lp
from problems.scenes.rivals import CLARABEL, HIGHS, PIQP
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Arch:
    """A half circle of stones with radial joints that take no tension and do not slide: how thin may it be?

    By the safe theorem it stands if some line of thrust, in equilibrium with the weights, lies within every joint. The
    program finds that line which leaves the largest moment to spare at every joint. By symmetry half the arch is
    modelled; a half circle of many stones stands from thickness .1075 times its mean radius on.

    Parameters
    ----------
    radius : float
        m, to the middle of the stones.
    thickness : float
        m.
    stones : int
        Of one half.
    weight : float
        N/m^3.

    References
    ----------
    Milankovitch, Z. Math. Phys. 55 (1907); Heyman, Int. J. Solids Struct. 2 (1966); Ochsendorf, The Structural
    Engineer 84 (2006), for .1075.
    """

    radius: float = positive(1.0)
    thickness: float = positive(0.15)
    stones: int = field(default=20, validator=integer(2))
    weight: float = positive(2e4)
    units: ClassVar[Units] = {"thrust": "N/m", "spare moment": "N", "stands": ""}
    rivals: ClassVar[tuple[Rival, ...]] = (HIGHS, PIQP, CLARABEL)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The two forces that symmetry leaves undetermined in the crown, and what each side of each joint bears."""
        return (
            Unknown("thrust, its moment, spare moment", 3, "every other force follows by equilibrium"),
            Unknown("rotations", 2 * (self.stones + 1), "at which joints hinges open, inside or outside"),
        )

    @property
    def _sides(self) -> tuple[float, float]:
        return self.radius - 0.5 * self.thickness, self.radius + 0.5 * self.thickness

    def _joints(self) -> tuple[Array, Array, Array]:
        """Angles from the crown, the weight above each joint, and its moment about the centre."""
        inner, outer = self._sides
        angle = np.linspace(0.0, 0.5 * np.pi, self.stones + 1)
        above = self.weight * 0.5 * (outer**2 - inner**2) * angle
        return angle, above, self.weight * (outer**3 - inner**3) / 3.0 * (1.0 - np.cos(angle))

    def problem(self) -> Program:
        """Max z: inner N + z <= M <= outer N - z, M the moment about the centre, N the force across the joint."""
        angle, above, moment = self._joints()
        one, (inner, outer) = np.ones(angle.size), self._sides
        across = np.stack([np.cos(angle), 0.0 * one], axis=1)
        G = np.concatenate([
            np.column_stack([inner * across - [0.0, 1.0], one]), np.column_stack([[0.0, 1.0] - outer * across, one]),
        ])  # fmt: skip
        h = np.concatenate([moment - inner * above * np.sin(angle), outer * above * np.sin(angle) - moment])
        # In units of the arch's weight, so that forces and moments are about 1.
        return from_lp([0.0, 0.0, -1.0], G, h / self._unit)

    @property
    def _unit(self) -> float:
        return self.weight * self.radius * self.thickness

    def answer(self, solution: Any) -> Quantities:
        """The arch stands if there is a moment to spare."""
        thrust, _, spare = self._unit * solution.x[:3]
        return {"thrust": thrust, "spare moment": spare, "stands": float(spare >= 0.0)}

    def exact(self) -> Quantities:
        """Milankovitch's limit, for many stones; so near to it that the number of stones decides, nothing."""
        ratio = self.thickness / self.radius
        return {"stands": float(ratio > 0.1075)} if abs(ratio - 0.1075) > 0.002 and self.stones >= 20 else {}

    def draw(self, solution: Any, axes: Any) -> None:
        """Joints, the line of thrust, and the joints at which it comes nearest to the surface."""
        angle, above, moment = self._joints()
        thrust, own, spare = self._unit * solution.x[:3]
        inner, outer = self._sides
        across = thrust * np.cos(angle) + above * np.sin(angle)
        r = (own + moment) / across
        for side in (-1.0, 1.0):
            for a in angle:
                axes.plot(
                    side * np.sin(a) * np.array([inner, outer]), np.cos(a) * np.array([inner, outer]), color="0.7"
                )
            for edge in (inner, outer):
                axes.plot(side * edge * np.sin(angle), edge * np.cos(angle), color="0.3")
            axes.plot(
                side * r * np.sin(angle), r * np.cos(angle), color="#D55E00", label="line of thrust" if side > 0 else ""
            )
            room = np.minimum(own + moment - inner * across, outer * across - own - moment)
            near = room <= spare + 1e-9 * self._unit
            axes.plot(side * (r * np.sin(angle))[near], (r * np.cos(angle))[near], "ko", markersize=4)
        axes.set(aspect="equal", xlabel="m from the middle", ylabel="height (m)")
        axes.set_title(f"{'stands' if spare >= 0.0 else 'falls'}: {spare:.3g} N to spare", fontsize="medium")
        axes.legend(frameon=False, loc="center")
