r"""
A partial differential equation of your own
===========================================

:math:`u'' + \lambda (u - u^3) = 0` on (0, 1), zero at both ends. The residual is written with numpy, its derivative is
taken from it, and the other branches are found where they leave :math:`u = 0`.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import plot_bifurcation, plot_profiles


class Layers:
    """Second differences on n points."""

    def __init__(self, n=30):
        self.n = n

    def start(self):
        return np.zeros(self.n), 5.0

    def residual(self, y, lam):
        wall = np.zeros(1)
        u = np.concatenate((wall, y, wall))
        return u[:-2] - 2.0 * y + u[2:] + lam * (y - y**3) / (self.n + 1) ** 2

    def observe(self, y, lam):
        return {"slope at the wall": float(y[0] * (self.n + 1))}


layers = Layers()
flat = continuation.trace(layers, target=100.0, max_step=0.05)
branches = [flat]
for event in flat.events:
    start, _ = continuation.switch_branch(layers, event, step=0.1)
    branches.append(continuation.trace(layers, start=start, target=100.0))
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
plot_bifurcation(branches, left, value="slope at the wall")
plot_profiles(branches[2], right, 4, np.arange(1, layers.n + 1) / (layers.n + 1))
print([round(event.lam, 3) for event in flat.events], "near", [round((k * np.pi) ** 2, 3) for k in (1, 2, 3)])
