"""
A pitchfork, its arms, and what is stable
=========================================

Three branches in one picture: solid where a perturbation dies away, dashed where it grows.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import plot_bifurcation
from problems.bifurcation import Pitchfork

pitchfork = Pitchfork()
trunk = continuation.trace(pitchfork)
(crossing,) = trunk.events
arms = [
    continuation.trace(pitchfork, start=start, target=1.0) for start in continuation.switch_branch(pitchfork, crossing)
]


def stable(y, lam):
    """All eigenvalues of the flow x' = lam x - x^3 are negative."""
    return bool((lam - 3.0 * y**2 <= 1e-12).all())


figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
plot_bifurcation([trunk, *arms], axes, value=0, stable=stable, names=["trunk", "upper arm", "lower arm"])
print(np.abs(crossing.u).max() < 1e-9)
