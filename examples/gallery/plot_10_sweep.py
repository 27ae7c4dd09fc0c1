"""
A sweep, and its archive
========================

Twenty resonance curves of an oscillator with a hardening spring, one for each force, in one file. The homotopy's
parameters are columns of the archive, so that the folds can be drawn against them.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.archive import trace_many
from continuation.plot import plot_bifurcation


class Duffing:
    """First harmonic of a damped oscillator with a cubic spring; the parameter is the frequency."""

    target = 2.5
    parameter_name = "frequency"
    names = ("a", "b")

    def __init__(self, force):
        self.force = force

    def start(self):
        return np.array([self.force, 0.0]), 0.1

    def residual(self, y, lam):
        stiffness = 1.0 - lam**2 + 0.75 * (y[0] ** 2 + y[1] ** 2)
        return np.stack([stiffness * y[0] + 0.1 * lam * y[1] - self.force, stiffness * y[1] - 0.1 * lam * y[0]])

    def observe(self, y, lam):
        return {"amplitude": float(np.hypot(*y))}


forces = np.linspace(0.05, 0.4, 20)
with (
    tempfile.TemporaryDirectory() as folder,
    trace_many([Duffing(force) for force in forces], archive=Path(folder) / "sweep.h5") as archive,
):
    paths = list(archive)
    folds = archive.points["kind"] == continuation.Kind.TURNING_POINT
    owner = archive.points["path_index"][folds]
    force, frequency = archive.paths["homotopy_force"][owner], archive.points["parameter"][folds]

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
plot_bifurcation(paths[::4], left, value="amplitude", legend=False)
right.plot(force, frequency, "o", markersize=4)
right.set(xlabel="force", ylabel="frequency of a fold")
print(f"{len(paths)} paths, {folds.sum()} folds")
