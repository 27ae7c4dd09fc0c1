"""A DC/DC converter in its periodic state."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import integer, number
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Converter:
    """A buck converter, with an ideal switch and an ideal diode, over one period of its periodic state.

    By the trapezoidal rule. The period closes on itself, so that all of it is one problem, and no transient is
    computed. The diode blocks where the coil's current would turn; with a light load it is zero for a part of the
    period, and the output is higher than duty * input.

    Parameters
    ----------
    voltage : float
        V, of the input.
    duty : float
        The part of the period for which the switch is closed.
    period : float
        s.
    inductance : float
        H.
    capacity : float
        F.
    load : float
        Ohm.
    n : int
        Steps in a period.

    References
    ----------
    Erickson and Maksimovic, Fundamentals of Power Electronics, 2001, chapter 5.
    """

    voltage: float = positive(12.0)
    duty: float = field(default=0.5, validator=number("a number between 0 and 1", lambda d: 0.0 < d < 1.0))
    period: float = positive(1e-5)
    inductance: float = positive(2e-5)
    capacity: float = positive(1e-4)
    load: float = positive(20.0)
    n: int = field(default=100, validator=integer(4))
    units: ClassVar[Units] = {
        "output": "V", "largest current": "A", "part without current": "", "mean input current": "A",
    }  # fmt: skip
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The coil's currents; the capacitor's voltages are linear in these."""
        return (Unknown("currents of the coil", self.n, "when the diode blocks"),)

    @property
    def _closed(self) -> Array:
        """The part of each step for which the switch is closed."""
        step = np.arange(self.n)
        return np.clip(self.duty * self.n - step, 0.0, 1.0)

    def _parts(self) -> tuple[Array, Array, Array]:
        """Differences and means of neighbours around the period, and currents to voltages."""
        before = np.roll(np.eye(self.n), -1, axis=1)
        one, h = np.eye(self.n), self.period / self.n
        difference, mean = one - before, 0.5 * (one + before)
        voltages: Array = np.asarray(
            np.linalg.solve(self.capacity / h * difference + mean / self.load, mean), dtype=float
        )
        return difference, mean, voltages

    def problem(self) -> LCP:
        """The voltage across the diode, mean over each step: at least zero, and zero while current flows."""
        difference, mean, voltages = self._parts()
        A = self.inductance * self.n / self.period * difference + mean @ voltages
        return LCP(A, -self.voltage * self._closed)

    def answer(self, solution: Any) -> Quantities:
        """Means over the period, by the trapezoidal rule."""
        _, mean, voltages = self._parts()
        i = np.asarray(solution.x)
        return {
            "output": float((voltages @ i).mean()), "largest current": float(i.max()),
            "part without current": float((mean @ i <= 1e-12 * i.max()).mean()),
            "mean input current": float((mean @ i) @ self._closed) / self.n,
        }  # fmt: skip

    def exact(self) -> Quantities:
        """For a capacitor so large that its voltage stands still."""
        K = 2.0 * self.inductance / (self.load * self.period)
        ratio = self.duty if 1.0 - self.duty <= K else 2.0 / (1.0 + (1.0 + 4.0 * K / self.duty**2) ** 0.5)
        return {"output": ratio * self.voltage}

    def draw(self, solution: Any, axes: Any) -> None:
        """The coil's current over the period."""
        i = np.asarray(solution.x)
        time = 1e6 * np.linspace(0.0, self.period, self.n + 1)
        axes.plot(time, np.append(i[-1], i), color="#0072B2", label="current of the coil")
        axes.axvspan(0.0, 1e6 * self.duty * self.period, color="#E69F00", alpha=0.15, label="switch closed")
        axes.set(xlabel="time (microseconds)", ylabel="current (A)")
        axes.set_title(f"output {self.answer(solution)['output']:.4g} V", fontsize="medium")
        axes.legend(frameon=False)
