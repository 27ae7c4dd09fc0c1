"""Bars that yield one after another, up to the collapse."""

from __future__ import annotations

from math import inf
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import NOT_NEGATIVE
from continuation.arrays import Array
from continuation.path import Path
from problems.lcp.data.problem import LCP
from problems.lcp.parametric.along import along
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, numbers, positive


@frozen
class Truss:
    """A rigid beam that hangs on parallel bars of different strength: how do they yield as the load grows?

    Each bar is elastic, then plastic with linear hardening. Without hardening the path of plastic strains ends at the
    collapse load, the most that the bars can bear: it goes on along a ray with no more load.

    Parameters
    ----------
    limits : sequence of float
        Forces at which the bars yield.
    stiffness : float
        Force per elongation, of each bar.
    hardening : float
        Force per plastic elongation; 0 is perfect plasticity.
    load : float

    References
    ----------
    Maier, "A matrix structural theory of piecewise linear elastoplasticity", Meccanica 5 (1970).
    """

    limits: tuple[float, ...] = numbers("limits", (0.3, 0.6, 1.2))
    stiffness: float = positive(1.0)
    hardening: float = field(default=0.0, validator=NOT_NEGATIVE)
    load: float = positive(1.9)
    units: ClassVar[Units] = {
        "plastic elongations": "length", "forces": "force", "collapse load": "force", "yield loads": "force",
    }  # fmt: skip
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Bars are pulled, never pressed: one yield limit each."""
        return (Unknown("plastic elongations", len(self.limits), "which bars have yielded; forces follow from them"),)

    def _matrix(self) -> Array:
        n = len(self.limits)
        return (self.stiffness + self.hardening) * np.eye(n) - self.stiffness / n * np.ones((n, n))

    def problem(self) -> LCP:
        """At the load: what is left up to each limit."""
        return LCP(self._matrix(), np.array(self.limits) - self.load / len(self.limits))

    def solve(self) -> Path:
        """The path of plastic elongations as the load grows from zero."""
        n = len(self.limits)
        return along(LCP(self._matrix(), np.array(self.limits)), np.full(n, -1.0 / n), (0.0, inf), x=np.zeros(n))

    def answer(self, solution: Any) -> Quantities:
        """At the load, where the bars can bear it."""
        n = len(self.limits)
        if not isinstance(solution, Path):
            strain = np.asarray(solution.x)
            collapse, yields = inf, np.zeros(0)
        else:
            end, v = solution.endpoint, solution.steps[-1].tangent
            collapse = inf if v[-1] > 1e-12 * np.abs(v).max() else end.lam
            yields = np.array([kink.lam for kink in solution.kinks])
            if self.load > collapse:
                raise ArithmeticError(f"load: the bars bear {collapse:g} at most, found {self.load:g}")
            beyond = (self.load - end.lam) / v[-1] if self.load > end.lam else None
            strain = solution(t=self.load)[:-1] if beyond is None else end.y + beyond * v[:-1]
        forces = self.load / n - self.stiffness * (strain - strain.mean())
        found = {"plastic elongations": strain, "forces": forces}
        return {**found, "collapse load": collapse, "yield loads": yields} if isinstance(solution, Path) else found

    def exact(self) -> Quantities:
        """The bars stretch alike: elastic to their limit, then by what hardening leaves."""
        limits = np.array(self.limits)
        soft = self.stiffness * self.hardening / (self.stiffness + self.hardening)

        def forces(stretch: float) -> Array:
            elastic = np.minimum(self.stiffness * stretch, limits)
            whole: Array = elastic + soft * np.maximum(stretch - limits / self.stiffness, 0.0)
            return whole

        yields = np.array([forces(limit / self.stiffness).sum() for limit in np.sort(limits)])
        stretches = np.sort(limits) / self.stiffness
        if self.hardening:
            slope = soft * limits.size
            last = stretches[-1] + max(self.load - yields[-1], 0.0) / slope
            stretch = float(np.interp(self.load, [0.0, *yields, slope * (last - stretches[-1]) + yields[-1] + 1e-300],
                                      [0.0, *stretches, last]))  # fmt: skip
            return {"plastic elongations": stretch - forces(stretch) / self.stiffness, "yield loads": yields}
        stretch = float(np.interp(self.load, [0.0, *yields], [0.0, *stretches]))
        return {
            "plastic elongations": stretch - forces(stretch) / self.stiffness, "forces": forces(stretch),
            "collapse load": limits.sum(),
        }  # fmt: skip

    def draw(self, solution: Any, axes: Any) -> None:
        """The load against the stretch of the bars, with a kink wherever one yields."""
        u, v = solution.u, solution.steps[-1].tangent
        u = np.vstack([u, u[-1] + v / np.abs(v).max() * 0.2 * np.abs(u).max()])
        stretch = u[:, -1] / len(self.limits) / self.stiffness + u[:, :-1].mean(axis=1)
        axes.plot(stretch, u[:, -1], color="#0072B2")
        loads = [kink.lam for kink in solution.kinks]
        axes.plot(np.interp(loads, u[:, -1], stretch) if self.hardening else stretch[1 : len(loads) + 1], loads, "kD",
                  markersize=5, label="a bar yields")  # fmt: skip
        axes.axhline(self.load, color="0.6", linewidth=0.8, zorder=0, label="the load")
        axes.set(xlabel="stretch (length)", ylabel="load (force)")
        axes.legend(frameon=False)
