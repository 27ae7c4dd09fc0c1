r"""
Kuramoto and Sivashinsky: steady flames
=======================================

Steady, odd, :math:`2 \pi`-periodic solutions of :math:`4 u_{xxxx} + \alpha (u_{xx} + u u_x) = 0`. The flat flame
:math:`u = 0` loses its stability at :math:`\alpha = 4 k^2`, where branches with k humps cross it: a path over branch
points, and the branches that leave there.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import plot_bifurcation


class Flame:
    """Galerkin's method with n sines."""

    parameter_name = "alpha"

    def __init__(self, n=12):
        self.n, self.k = n, np.arange(1, n + 1)
        x = np.pi * np.arange(1, 2 * n + 2) / (2 * n + 2)
        self.sines, self.slopes = np.sin(np.outer(x, self.k)), np.cos(np.outer(x, self.k)) * self.k
        self.back = self.sines.T / (n + 1) / self.k[:, None] ** 2

    def start(self):
        return np.zeros(self.n), 2.0

    def residual(self, y, lam):
        return 4.0 * self.k**2 * y + lam * (self.back @ ((self.sines @ y) * (self.slopes @ y)) - y)

    def observe(self, y, lam):
        return {"energy": float(np.sqrt(np.sum(y**2)))}


flame = Flame()
flat = continuation.trace(flame, target=20.0)
crossings = [event for event in flat.events if event.kind == continuation.Kind.BRANCH_POINT]
print([round(event.lam, 8) for event in crossings])

# %%
# At each crossing the other branch is begun on one side (the other side is the same flame, shifted).

branches = [flat]
for crossing in crossings:
    start, _ = continuation.switch_branch(flame, crossing, step=0.05)
    # The coefficients of smooth functions fall to 1e-19: measured each by itself, the last ones would be round-off.
    metric = continuation.Euclidean()
    branches.append(continuation.trace(flame, start=start, target=None, metric=metric, box={"lam": (2.0, 20.0)}))
figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
plot_bifurcation(branches, axes, value="energy", names=["flat", "one hump", "two humps"])

# %%
# The flames of greatest energy on the two branches.

figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
x = np.linspace(0.0, 2.0 * np.pi, 200)
for branch, name in zip(branches[1:], ("one hump", "two humps")):
    highest = max(branch.steps, key=lambda step: step.observed["energy"])
    axes.plot(x, np.sin(np.outer(x, flame.k)) @ highest.y, label=f"{name}, alpha = {highest.lam:.3g}")
axes.set(xlabel="$x$", ylabel="$u$")
axes.legend(frameon=False)
