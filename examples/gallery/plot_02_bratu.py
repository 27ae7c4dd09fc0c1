"""
Bratu's problem: two branches, one path
=======================================

:math:`u'' + \\lambda e^u = 0` with :math:`u(0) = u(1) = 0` has two solutions for small :math:`\\lambda` and none for
large. One path joins them, through a turning point. The upper branch has no end, so the trace is told where to stop.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import TURN
from problems.bifurcation import Bratu1D

homotopy = Bratu1D(n=200)
path = continuation.trace(homotopy, events=[continuation.TargetValue(0.2, direction=-1)])
(fold,) = path.turning_points
print(f"fold at lambda = {fold.lam:.9f}, max u = {fold.y.max():.9f}; {len(path)} points")

# %%
# The fold parts the path into the branches: below it the stable solutions, above it the others.

figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
for name, first, last, style in (
    ("lower branch", 0.0, fold.arclength, "-"),
    ("upper branch", fold.arclength, path.arclength[-1], "--"),
):
    u = path(np.linspace(first, last, 150))
    axes.plot(u[:, -1], u[:, :-1].max(axis=1), style, label=name)
axes.plot(fold.lam, fold.y.max(), label="fold", **TURN)
axes.set(xlabel=r"$\lambda$", ylabel=r"$\max\,u$")
axes.legend(frameon=False)

# %%
# The two solutions at :math:`\lambda = 1`, located by an event on the way up and on the way down.

at_one = continuation.TargetValue(1.0, terminal=2)
path = continuation.trace(homotopy, events=[at_one])
figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
x = np.linspace(0, 1, homotopy.n + 2)
crossings = [event for event in path.events if event.name == at_one.name]
for name, event, style in zip(("lower branch", "upper branch"), crossings, ("-", "--")):
    axes.plot(x, np.pad(event.y, 1), style, label=f"{name}, max u = {event.y.max():.4f}")
axes.set(xlabel="$x$", ylabel="$u$")
axes.legend(frameon=False)
