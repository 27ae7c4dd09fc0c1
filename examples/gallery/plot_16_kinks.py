"""
Paths with kinks
================

A bar is pushed against springs that act only while they are pressed: the equations have corners, and the path has kinks
where a spring comes into play. Each is an event: the place where a gap closes.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.controllers import Bounds, Fixed

gaps, stiffness = np.array([0.2, 0.5]), np.array([3.0, 8.0])


def residual(y, lam):
    pressed = y[0] - gaps
    return np.array([y[0] + np.sum(stiffness * np.where(pressed > 0.0, pressed, 0.0)) - lam])


def derivative(y, lam):
    return np.array([[1.0 + np.sum(stiffness[y[0] > gaps])]]), np.array([-1.0])


bar = continuation.from_functions(residual, start=([0.0], 0.0), jacobian=derivative, target=6.0)
contacts = [continuation.Monitor(lambda u, v, gap=gap: u[0] - gap, f"contact at {gap:g}") for gap in gaps]
path = continuation.trace(bar, events=contacts, controller=Fixed(bounds=Bounds(initial=0.05)))
for event in path.events:
    print(f"{event.name}: force {event.lam:.8f}")
figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
path.plot(axes, value=0)
axes.set_xlabel("force")
axes.set_ylabel("position")
