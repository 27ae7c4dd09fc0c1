"""A bridge of four ideal diodes that rectifies a voltage."""

from __future__ import annotations

from math import pi
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE
from continuation.arrays import Array
from continuation.path import Path
from problems.lcp.data.problem import LCP
from problems.lcp.parametric.along import along
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class DiodeBridge:
    """A source, four ideal diodes and a load: which diodes conduct, and what does the load get?

    The path over all voltages from -amplitude to amplitude has one kink, at zero, where all four diodes switch at once.

    Parameters
    ----------
    voltage : float
        V, of the source, where the answer gives currents.
    amplitude : float
        V.
    load : float
        Ohm.
    source_resistance : float
        Ohm.

    References
    ----------
    Acary and Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, 2008, chapter 11.
    """

    voltage: float = field(default=5.0, validator=FINITE)
    amplitude: float = positive(10.0)
    load: float = positive(100.0)
    source_resistance: float = positive(1.0)
    units: ClassVar[Units] = {"load voltage": "V", "diode currents": "A", "mean load voltage": "V"}
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES)

    def __attrs_post_init__(self) -> None:
        if abs(self.voltage) > self.amplitude:
            raise ValueError(f"voltage: expected at most the amplitude, {self.amplitude}, found {self.voltage}")

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """One for each diode; Kirchhoff's laws give everything else."""
        return (
            Unknown("currents of the upper diodes", 2, "which of them conducts"),
            Unknown("voltages across the lower diodes", 2, "which of these does not conduct"),
        )

    def _network(self) -> tuple[Array, Array]:
        """The matrix, and q for one volt: upper diodes to the load, lower ones back to both ends of the source."""
        R, g = self.load, 1.0 / self.source_resistance
        A = np.array([[R, R, -1.0, 0.0], [R, R, 0.0, -1.0], [1.0, 0.0, g, -g], [0.0, 1.0, -g, g]])
        return A, np.array([0.0, 0.0, -g, g])

    def problem(self) -> LCP:
        """At the voltage of the source."""
        A, one = self._network()
        return LCP(A, self.voltage * one)

    def solve(self) -> Path:
        """The path over the voltages."""
        A, one = self._network()
        # Below zero the second upper diode conducts.
        current = self.amplitude / (self.load + self.source_resistance)
        start = np.array([0.0, current, 0.0, self.load * current])
        return along(LCP(A, np.zeros(4)), one, (-self.amplitude, self.amplitude), x=start)

    def answer(self, solution: Any) -> Quantities:
        """At the voltage, and the mean over a period of a sine."""
        x = solution(t=self.voltage)[:-1] if isinstance(solution, Path) else np.asarray(solution.x)
        A, one = self._network()
        w = A @ x + self.voltage * one
        found = {"load voltage": self.load * float(x[0] + x[1]), "diode currents": np.append(x[:2], w[2:])}
        if not isinstance(solution, Path):
            return found
        # Between kinks the load's voltage is linear in the source's, so its mean is in closed form: over a quarter of a
        # sine, from its zero to its peak, each way.
        v, u = solution.lam, self.load * solution.y[:, :2].sum(axis=1)
        angle = np.arcsin(np.clip(v / self.amplitude, -1.0, 1.0))
        slope = np.diff(u) / np.diff(v)
        whole = (u[:-1] - slope * v[:-1]) * np.diff(angle) - slope * self.amplitude * np.diff(np.cos(angle))
        return {**found, "mean load voltage": float(whole.sum()) / pi}

    def exact(self) -> Quantities:
        """The absolute value, divided by the two resistances."""
        part = self.load / (self.load + self.source_resistance)
        i = abs(self.voltage) * part / self.load
        forward = np.array([i, 0.0, 0.0, i] if self.voltage > 0.0 else [0.0, i, i, 0.0])
        return {
            "load voltage": abs(self.voltage) * part, "diode currents": forward,
            "mean load voltage": 2.0 / pi * self.amplitude * part,
        }  # fmt: skip

    def draw(self, solution: Any, axes: Any) -> None:
        """Voltages of source and load over a period."""
        time = np.linspace(0.0, 2.0, 401)
        source = self.amplitude * np.sin(pi * time)
        load = self.load * np.interp(source, solution.lam, solution.y[:, :2].sum(axis=1))
        axes.plot(time, source, "--", color="0.6", label="source")
        axes.plot(time, load, color="#D55E00", label="load")
        axes.set(xlabel="time (half periods)", ylabel="voltage (V)")
        axes.legend(frameon=False)
