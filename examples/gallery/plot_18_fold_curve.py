"""
A fold moves, and meets another: a cusp
=======================================

A slab that heats itself ignites at one load and goes out at a lower one. As the activation energy falls (eps grows) the
two folds approach each other and vanish in a cusp: beyond it nothing ignites any more. Left, the slab's temperature for
several eps, with the curve of folds through them; right, where there are two stable states.
"""

import matplotlib.pyplot as plt
import numpy as np
from attrs import frozen

import continuation


@frozen
class Slab:
    """u'' + lam exp(u / (1 + eps u)) = 0 on (-1, 1), zero at the ends, by second-order differences."""

    eps: float = 0.2
    n: int = 30
    target = None

    def start(self):
        return np.zeros(self.n), 0.0

    def residual(self, y, lam):
        u = np.concatenate((np.zeros(1), y, np.zeros(1)))
        return u[:-2] - 2.0 * y + u[2:] + (2.0 / (self.n + 1)) ** 2 * lam * np.exp(y / (1.0 + self.eps * y))


ignition = continuation.trace(Slab(), events=[continuation.TurningPoint(terminal=1)]).turning_points[0]
curve = continuation.Curve(continuation.Family(Slab(), "eps"), ignition)
folds = continuation.trace_both(curve, box={"lam": (0.17, None)})
(cusp,) = [event for event in folds.events if event.name == "cusp"]
print(f"cusp at eps = {cusp.lam:.6f}, delta = {cusp.u[-2]:.6f}")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
for eps in (0.17, 0.185, 0.2, 0.22, cusp.lam, 0.28):
    path = continuation.trace(Slab(eps), box={"lam": (None, 2.2), "y": (None, 25.0)})
    s = path(np.linspace(0.0, path.arclength[-1], 300))
    left.plot(s[:, -1], s[:, :-1].max(axis=1), color="0.6", linewidth=1.0)
dense = folds(np.linspace(0.0, folds.arclength[-1], 400))
left.plot(dense[:, -2], dense[:, :-2].max(axis=1), color="C1", label="folds")
left.plot(cusp.u[-2], cusp.u[:-2].max(), "ko", markersize=5, label="cusp")
left.set(xlabel="load delta", ylabel="max u", xlim=(0.0, 2.2), ylim=(0.0, 25.0))
left.legend()
right.fill(dense[:, -1], dense[:, -2], color="C1", alpha=0.15)
right.plot(dense[:, -1], dense[:, -2], color="C1")
right.plot(cusp.lam, cusp.u[-2], "ko", markersize=5)
right.set(xlabel="eps", ylabel="load delta")
right.annotate("two stable states", (0.172, 0.85), color="C1")
right.annotate("hot", (0.19, 1.22))
right.annotate("cold", (0.205, 0.75))
