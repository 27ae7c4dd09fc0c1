"""
A circuit with a diode
======================

Two diodes in series with a resistor: exponentials, so that Newton's method from zero volts at full drive fails, while
the path from zero drive arrives. `solve_at` gives one more point of it.
"""

from typing import ClassVar

import matplotlib.pyplot as plt
import numpy as np

import continuation


class Circuit:
    """Voltages over one diode and the resistor, against the drive."""

    target = 5.0
    parameter_name = "drive"
    names = ("diode", "resistor")
    units: ClassVar = {"drive": "V", "diode": "V", "resistor": "V"}

    def start(self):
        return np.zeros(2), 0.0

    def residual(self, y, lam):
        current = 1e-9 * np.expm1(y[0] / 0.05)
        return np.stack([y[1] - 1e3 * current, 2.0 * y[0] + y[1] - lam])


circuit = Circuit()
path = continuation.trace(circuit)
print(path.endpoint.y.round(6), continuation.solve_at(circuit, 4.5, path.endpoint.y).round(6))
figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
path.plot(axes)
