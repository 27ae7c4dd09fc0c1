"""
Stability along a path
======================

The cusp's surface, cut at one splitting factor: of three equilibria the middle one is unstable. The homotopy observes
the decay rate, and the picture is dashed where that is negative.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from problems.bifurcation import Cusp


class Decay(Cusp):
    """The cusp, with the rate at which perturbations of x' = mu + lambda x - x^3 die away."""

    def observe(self, y, lam):
        return {"x": float(y[0]), "decay": float(3.0 * y[0] ** 2 - self.splitting)}


path = continuation.trace(Decay(splitting=1.0))
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
path.plot(left, value="x", stable=lambda y, lam: 3.0 * y[0] ** 2 > 1.0)
path.plot(right, value="decay", against="arclength", legend=False)
right.axhline(0.0, color="0.6", linewidth=0.8)
for event in path.events:
    print(f"{event.name} at {event.lam:.6f}, decay {abs(event.observed['decay']):.0e}")
print(f"theory has them at {2.0 / 3.0**1.5:.6f} and minus that; {len(np.unique(path.lam))} points")
