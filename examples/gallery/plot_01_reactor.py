"""
A first homotopy of one's own: a reactor that ignites
=====================================================

A stirred tank is fed with a reactant that heats it as it reacts. With the Damköhler number :math:`\\lambda` (how long
the reactant stays), the conversion :math:`x` in the steady state satisfies

.. math:: x = \\lambda \\, (1 - x) \\, \\exp \\frac{B x}{1 + B x / \\gamma}.

A class with two methods is all that the tracer needs.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.testing import check_homotopy


class Reactor:
    """Steady states of a stirred tank that heats itself, over the Damköhler number."""

    target = 0.2

    def __init__(self, heat=10.0, gamma=20.0):
        self.heat = heat
        self.gamma = gamma

    def start(self):
        return np.array([0.0]), 0.0

    def residual(self, y, lam):
        return y - lam * (1 - y) * np.exp(self.heat * y / (1 + self.heat * y / self.gamma))


path = continuation.trace(Reactor())
print(path.status)
for turn in path.turning_points:
    print(f"turning point at lambda = {turn.lam:.8f}, x = {turn.y[0]:.6f}")

# %%
# Between the two turning points there are three states at one :math:`\lambda`. A reactor whose feed is slowly throttled
# up follows the lower branch to its end and jumps to the upper one; throttled down, it jumps back elsewhere.

ignition, extinction = path.turning_points
figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
s = np.linspace(0, path.arclength[-1], 400)
x, lam = path(s).T
unstable = (s > ignition.arclength) & (s < extinction.arclength)
axes.plot(np.where(unstable, np.nan, lam), x, label="stable")
axes.plot(np.where(unstable, lam, np.nan), x, "--", label="unstable")
for name, turn in (("ignition", ignition), ("extinction", extinction)):
    axes.plot(turn.lam, turn.y[0], "o", color="black", markerfacecolor="white")
    axes.annotate(name, (turn.lam, turn.y[0]), (8, -4), textcoords="offset points")
axes.set(xlabel=r"Damköhler number $\lambda$", ylabel="conversion $x$")
axes.legend(frameon=False, loc="lower right")

# %%
# Whether the class is right, the conformance suite says. The tutorial, "Your own homotopy", has more on it.

for result in check_homotopy(Reactor()):
    print(result.outcome, result.name)
