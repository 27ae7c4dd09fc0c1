"""
Nerve cells that fire: periodic orbits from Hopf point to Hopf point
====================================================================

The model of Morris and Lecar (Biophysical Journal 35, 1981): under a current the cell's rest loses its stability at a
Hopf point, and regains it at another one. The orbits between them turn twice: where three lines are drawn above one
current, rest and firing are both stable, and which one is seen depends on the past.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import plot_bifurcation
from problems.orbits import PeriodicOrbit, plot_orbits


def morris_lecar(z, current):
    v, w = z
    m, w_inf = 0.5 * (1.0 + np.tanh((v + 1.2) / 18.0)), 0.5 * (1.0 + np.tanh((v - 2.0) / 30.0))
    v_dot = (current - 2.0 * (v + 60.0) - 4.4 * m * (v - 120.0) - 8.0 * w * (v + 84.0)) / 20.0
    return np.stack([v_dot, 0.04 * np.cosh((v - 2.0) / 60.0) * (w_inf - w)])


# %%
# The equilibria, their stability, and the Hopf points.
rest = continuation.from_functions(morris_lecar, start=([-60.0, 0.015], 0.0), target=300.0)
equilibria = continuation.trace(rest, observers=[continuation.Stability()])
first, last = (event for event in equilibria.events if event.kind == continuation.Kind.HOPF)
print(f"Hopf points at {first.lam:.4f} and {last.lam:.4f}")

# %%
# The orbits that leave the first one. `follow` gives them a new mesh after every few steps.
orbit = PeriodicOrbit.from_hopf(morris_lecar, first, intervals=30)
followed = continuation.follow(orbit, start=orbit.leaving, budget=continuation.Budget(steps=200))
cycles = followed.path
for event in cycles.events:
    print(f"{event.name:13} at {event.lam:9.4f}, period {event.observed['period']:8.4f}")

# %%
# Their least and largest voltage, solid where they are stable; orbits in the plane, and the period.
figure, (left, middle, right) = plt.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
plot_bifurcation(equilibria, left, value=0, legend=False)
for side in ("min 0", "max 0"):
    plot_bifurcation(cycles, left, value=side, legend=False)
left.set(xlabel="current", ylabel="voltage")
shown = [step for step in cycles.steps if step.observed["unstable"] == 0.0][::6]
plot_orbits(orbit, shown, middle)
middle.set(xlabel="voltage", ylabel="open potassium channels")
plot_bifurcation(cycles, right, value="period", legend=False)
right.set(xlabel="current", ylabel="period")
