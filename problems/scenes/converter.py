"""A DC/DC converter."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import FRACTION, integer
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Converter(
    voltage: Positive = 12.0, duty: Annotated[float, FRACTION] = 0.5, period: Positive = 1e-5,
    inductance: Positive = 2e-5, capacity: Positive = 1e-4, load: Positive = 20.0,
    n: Annotated[int, integer(4)] = 100,
) -> Scene:  # fmt: skip
    """The periodic state of a buck converter with an ideal switch and an ideal diode.

    At light load the current pauses and the output exceeds duty * voltage.

    Parameters
    ----------
    voltage, load : float
        V (input); Ohm.
    duty : float
        Fraction of the period with closed switch.
    period, inductance, capacity : float
        s, H, F.
    n : int
        Steps per period.

    References
    ----------
    Erickson and Maksimovic, Fundamentals of Power Electronics, 2001, chapter 5.
    """
    closed = np.clip(duty * n - np.arange(n), 0.0, 1.0)
    one, before, h = np.eye(n), np.roll(np.eye(n), -1, axis=1), period / n
    difference, mean = one - before, 0.5 * (one + before)
    voltages = np.linalg.solve(capacity / h * difference + mean / load, mean)

    def answer(solution: Any) -> Quantities:
        i = np.asarray(solution.x)
        return {
            "output": float((voltages @ i).mean()), "largest current": float(i.max()),
            "part without current": float((mean @ i <= 1e-12 * i.max()).mean()),
            "mean input current": float((mean @ i) @ closed) / n,
        }  # fmt: skip

    def exact() -> Quantities:
        """Holds for a large capacity."""
        K = 2.0 * inductance / (load * period)
        ratio = duty if 1.0 - duty <= K else 2.0 / (1.0 + (1.0 + 4.0 * K / duty**2) ** 0.5)
        return {"output": ratio * voltage}

    def drawn(solution: Any) -> Picture:
        time, i = 1e6 * np.linspace(0.0, period, n + 1), np.asarray(solution.x)
        return picture(
            mark("plot", time, np.append(i[-1], i), color="#0072B2", label="current of the coil"),
            mark("axvspan", 0.0, 1e6 * duty * period, color="#E69F00", alpha=0.15, label="switch closed"),
            xlabel="time (microseconds)", ylabel="current (A)", title=f"output {answer(solution)['output']:.4g} V",
        )  # fmt: skip

    return Scene(
        units={"output": "V", "largest current": "A", "part without current": "", "mean input current": "A"},
        unknowns=(Unknown("currents of the coil", n, "when the diode blocks"),),
        # Mean diode voltage, zero while current flows.
        problem=lambda: LCP(inductance * n / period * difference + mean @ voltages, -voltage * closed),
        answer=answer, exact=exact, picture=drawn, rivals=(LEMKE, TABLES),
    )  # fmt: skip
