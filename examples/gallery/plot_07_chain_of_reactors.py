r"""
A chain of reactors
===================

Five stirred tanks in a row, each with an exothermic reaction: heat flows on with the stream, and each tank can ignite.
The unknowns and the parameter have names, and so have the axes.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import plot_bifurcation


class Reactors:
    """Temperatures of the tanks, in units of the adiabatic rise, against the logarithm of the residence time."""

    parameter_name = "log residence time"
    target = 1.0

    def __init__(self, tanks=5, heat=14.0):
        self.tanks, self.heat = tanks, heat
        self.names = tuple(f"tank {k + 1}" for k in range(tanks))

    def start(self):
        return np.zeros(self.tanks), -8.0

    def residual(self, y, lam):
        before = np.concatenate((np.zeros(1), y[:-1]))
        # What is left of the reactant is what has not become heat.
        return before - y + np.exp(lam) * (1.0 - y) * np.exp(self.heat * y / (1.0 + y))


path = continuation.trace(Reactors(), max_step=0.2)
print(path.status.name, f"{len(path.turning_points)} folds")
figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
plot_bifurcation(path, axes, value="tank 5")

# %%
# All tanks along the path: against the parameter the curves would lie over one another.

figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
path.plot(axes, against="arclength")
