r"""
Swift and Hohenberg: a pattern of many unknowns
===============================================

:math:`r u - (1 + \partial_x^2)^2 u + 2 u^2 - u^3 = 0` on half of a line, with mirrors at both ends. The tracer finds
that the derivative of the residual is a band of five diagonals: the work of a step is proportional to the number of
unknowns. The path of a localized pattern runs
back and forth; each turn adds a hump.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import plot_bifurcation, plot_profiles


class Pattern:
    """Second differences on n points of (0, length)."""

    parameter_name = "r"
    target = None

    def __init__(self, n=300, length=40.0):
        self.n = n
        self.x = (np.arange(n) + 0.5) * length / n
        self.square = (length / n) ** 2

    def start(self):
        return 1.5 * np.cos(self.x) / np.cosh(0.25 * self.x), -0.4

    def once(self, u):
        mirrored = np.concatenate((u[:1], u, u[-1:]))
        return u + (mirrored[:-2] - 2.0 * u + mirrored[2:]) / self.square

    def residual(self, y, lam):
        return (lam + 2.0 * y - y * y) * y - self.once(self.once(y))

    def observe(self, y, lam):
        return {"norm": float(np.sqrt(np.mean(y * y)))}


pattern = Pattern()
path = continuation.trace(pattern, tolerance=1e-6, budget=continuation.Budget(steps=120), direction=1)
print(path.status.name, f"{len(path)} points, {len(path.turning_points)} folds, {path.counts.factorizations} factors")
figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
plot_bifurcation(path, axes, value="norm")

# %%
# What 300 unknowns do, as a map of colours, and at a few points of the path.

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
s = np.linspace(0.0, path.arclength[-1], 300)
left.pcolormesh(s, pattern.x, path(s)[:, :-1].T, shading="nearest", rasterized=True)
left.set(xlabel="arclength $s$", ylabel="$x$")
plot_profiles(path, right, 4, pattern.x)
