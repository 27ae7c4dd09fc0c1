"""A diode bridge."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from continuation.arguments.checks import expect
from continuation.path import Path
from problems.lcp.data.problem import LCP
from problems.lcp.parametric.along import along
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import Finite, Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def DiodeBridge(
    voltage: Finite = 5.0, amplitude: Positive = 10.0, load: Positive = 100.0, source_resistance: Positive = 1.0
) -> Scene:
    """Which of four ideal diodes conduct, and what does the load get?

    All diodes switch at zero, the one kink of the path from -amplitude to amplitude.

    Parameters
    ----------
    voltage : float
        V, where currents are reported.
    amplitude : float
        V.
    load, source_resistance : float
        Ohm.

    References
    ----------
    Acary and Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, 2008, chapter 11.
    """
    expect(abs(voltage) <= amplitude, "voltage", f"at most the amplitude, {amplitude}", voltage)
    R, g = load, 1.0 / source_resistance
    A = np.array([[R, R, -1.0, 0.0], [R, R, 0.0, -1.0], [1.0, 0.0, g, -g], [0.0, 1.0, -g, g]])
    one = np.array([0.0, 0.0, -g, g])

    def solved() -> Path:
        """The second upper diode conducts below zero."""
        current = amplitude / (load + source_resistance)
        start = np.array([0.0, current, 0.0, load * current])
        return along(LCP(A, np.zeros(4)), one, (-amplitude, amplitude), x=start)

    def answer(solution: Any) -> Quantities:
        x = solution(t=voltage)[:-1]
        w = A @ x + voltage * one
        return {
            "load voltage": load * float(x[0] + x[1]), "diode currents": np.append(x[:2], w[2:]),
            "mean load voltage": mean(solution),
        }  # fmt: skip

    def mean(solution: Path) -> float:
        """Integrate the load voltage over a sine exactly."""
        v, u = solution.lam, load * solution.y[:, :2].sum(axis=1)
        angle = np.arcsin(np.clip(v / amplitude, -1.0, 1.0))
        slope = np.diff(u) / np.diff(v)
        whole = (u[:-1] - slope * v[:-1]) * np.diff(angle) - slope * amplitude * np.diff(np.cos(angle))
        return float(whole.sum()) / pi

    def exact() -> Quantities:
        part = load / (load + source_resistance)
        i = abs(voltage) * part / load
        return {
            "load voltage": abs(voltage) * part,
            "diode currents": np.array([i, 0.0, 0.0, i] if voltage > 0.0 else [0.0, i, i, 0.0]),
            "mean load voltage": 2.0 / pi * amplitude * part,
        }

    def drawn(solution: Any) -> Picture:
        time = np.linspace(0.0, 2.0, 401)
        source = amplitude * np.sin(pi * time)
        got = load * np.interp(source, solution.lam, solution.y[:, :2].sum(axis=1))
        return picture(
            mark("plot", time, source, "--", color="0.6", label="source"),
            mark("plot", time, got, color="#D55E00", label="load"),
            xlabel="time (half periods)", ylabel="voltage (V)",
        )  # fmt: skip

    return Scene(
        units={"load voltage": "V", "diode currents": "A", "mean load voltage": "V"},
        unknowns=(
            Unknown("currents of the upper diodes", 2, "which of them conducts"),
            Unknown("voltages across the lower diodes", 2, "which of these does not conduct"),
        ),
        problem=lambda: LCP(A, voltage * one),
        solve=solved, answer=answer, exact=exact, picture=drawn,
    )  # fmt: skip
