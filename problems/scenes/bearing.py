"""A journal bearing whose oil film breaks."""

from __future__ import annotations

from math import acos, degrees, pi
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from scipy.integrate import quad
from scipy.optimize import brentq

from continuation.arguments.checks import integer, number
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.rivals import GAUSS_SEIDEL, LEMKE, QUADRATIC
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Bearing:
    """A long journal bearing: where does the oil film break, and which load does it bear?

    Reynolds' equation with the condition of Swift and Stieber, p >= 0, by second-order finite volumes around the shaft.

    Parameters
    ----------
    eccentricity : float
        Between 0 and 1.
    radius : float
        m.
    clearance : float
        m.
    viscosity : float
        Pa s.
    speed : float
        rad/s.
    n : int
        Points around the shaft, without that of the widest gap.

    References
    ----------
    Cryer, "The method of Christopherson for solving free boundary problems for infinite journal bearings", Math. Comp.
    25 (1971).
    """

    eccentricity: float = field(default=0.8, validator=number("a number between 0 and 1", lambda e: 0.0 < e < 1.0))
    radius: float = positive(0.05)
    clearance: float = positive(5e-5)
    viscosity: float = positive(0.02)
    speed: float = positive(100.0)
    n: int = field(default=199, validator=integer(4))
    units: ClassVar[Units] = {"film breaks at": "degrees", "largest pressure": "Pa", "load": "N/m"}
    rivals: ClassVar[tuple[Rival, ...]] = (GAUSS_SEIDEL, LEMKE, *QUADRATIC)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Pressures; where the film is broken they are zero, and the gap is not full."""
        return (Unknown("pressures", self.n, "where the film is, and what it bears"),)

    @property
    def unit(self) -> float:
        """Of pressure, Pa."""
        return 6.0 * self.viscosity * self.speed * (self.radius / self.clearance) ** 2

    def _gap(self, angle: Any) -> Any:
        """Over the clearance, widest at 0."""
        return 1.0 + self.eccentricity * np.cos(angle)

    def problem(self) -> LCP:
        """Flows out of the cells."""
        h = 2.0 * pi / (self.n + 1)
        gap = self._gap(h * (np.arange(self.n + 1) + 0.5))
        k = gap**3 / h
        A = sp.diags_array([-k[1:-1], k[:-1] + k[1:], -k[1:-1]], offsets=[-1, 0, 1], format="csr")
        return LCP(A, np.diff(gap))

    def answer(self, solution: Any) -> Quantities:
        """The flow is the same all along the film, and is the gap where it breaks: second order in h."""
        p, h = solution.x, 2.0 * pi / (self.n + 1)
        gap = float(self._gap(0.5 * h))
        breaks = 2.0 * pi - acos(min(max((gap - gap**3 * p[0] / h - 1.0) / self.eccentricity, -1.0), 1.0))
        angle = h * np.arange(1, self.n + 1)
        return {
            "film breaks at": degrees(breaks), "largest pressure": self.unit * _peak(p),
            "load": self.unit * self.radius * h * float(np.hypot(p @ np.cos(angle), p @ np.sin(angle))),
        }  # fmt: skip

    def exact(self) -> Quantities:
        """By quadrature of (gap - gap where it breaks) / gap^3, which is p'."""

        def slope(angle: float, breaks: float) -> float:
            return float((self._gap(angle) - self._gap(breaks)) / self._gap(angle) ** 3)

        def pressure(angle: float, breaks: float) -> float:
            return float(quad(slope, 0.0, angle, args=(breaks,), epsabs=1e-12, epsrel=1e-11)[0])

        breaks = float(brentq(lambda b: pressure(b, b), pi + 1e-6, 2.0 * pi - 1e-6, xtol=1e-14))
        # By parts, since p is zero at both ends.
        parts = [quad(lambda a, f=f: slope(a, breaks) * f(a), 0.0, breaks, epsabs=1e-12, epsrel=1e-11)[0]
                 for f in (np.sin, np.cos)]  # fmt: skip
        return {
            "film breaks at": degrees(breaks),
            "largest pressure": self.unit * pressure(2.0 * pi - breaks, breaks),
            "load": self.unit * self.radius * float(np.hypot(*parts)),
        }  # fmt: skip

    def draw(self, solution: Any, axes: Any) -> None:
        """Pressure around the shaft, and the gap."""
        angle = np.linspace(0.0, 360.0, self.n + 2)
        axes.plot(angle, 1e-6 * self.unit * np.pad(solution.x, 1), color="#0072B2", label="pressure")
        breaks = self.answer(solution)["film breaks at"]
        axes.axvline(breaks, color="0.5", linestyle=":", label=f"film breaks at {breaks:.2f} degrees")
        axes.set(xlabel="degrees from the widest gap", ylabel="pressure (MPa)", xticks=range(0, 361, 60))
        axes.legend(frameon=False)


def _peak(p: Array) -> float:
    """The top of the parabola through the largest value and its neighbours."""
    k = min(max(int(np.argmax(p)), 1), p.size - 2)
    a, b, c = p[k - 1 : k + 2]
    bend = a - 2.0 * b + c
    return float(b - (c - a) ** 2 / (8.0 * bend)) if bend < 0.0 else float(b)
