"""
An aircraft that departs in roll
================================

Equilibria of an aircraft at three settings of the elevator, continued in the aileron both ways. Where a curve turns, a
steady roll ceases to exist, and the aircraft jumps to another one. The model has five quadratic equations, of Melhem
and Rheinboldt.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import TURN
from problems.bifurcation import Aircraft

limits = [continuation.TargetValue(-0.6), continuation.TargetValue(0.6)]
settings = {-0.05: ("#0072B2", "-"), -0.008: ("#D55E00", "--"), 0.0: ("#009E73", "-.")}

figure, axes = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
for elevator, (colour, style) in settings.items():
    for direction in (-1, 1):
        path = continuation.trace(Aircraft(elevator), direction=direction, events=limits)
        u = path(np.linspace(0, path.arclength[-1], 300))
        name = f"elevator {elevator:g}" if direction > 0 else None
        axes.plot(u[:, -1], u[:, 0], style, color=colour, label=name)
        for turn in path.turning_points:
            axes.plot(turn.lam, turn.y[0], **TURN)
        turns = ", ".join(f"{turn.lam:.6f}" for turn in path.turning_points) or "none"
        print(f"elevator {elevator:6g}, aileron towards {0.6 * direction:4}: {path.status.name}, turns at {turns}")
axes.set(xlabel="aileron deflection", ylabel="roll rate", ylim=(-5, 6))
axes.legend(frameon=False, loc="upper right", ncols=3, fontsize="small")
