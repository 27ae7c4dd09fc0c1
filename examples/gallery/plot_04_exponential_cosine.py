"""
A path that winds past itself
=============================

:math:`x_k = \\lambda \\exp \\cos (k \\sum_j x_j)`, from the origin to :math:`\\lambda = 1`: Watson's test. Neighbouring
turns come close, and a step that is too long lands on the wrong one. The controller keeps to the curve.
"""

import matplotlib.pyplot as plt

import continuation
from continuation.plot import plot_components, plot_steps
from problems.bifurcation import ExponentialCosine

path = continuation.trace(ExponentialCosine(5))
print(path.status)
print(path.counts)

figure, (above, below) = plt.subplots(2, 1, figsize=(6.4, 5.6), height_ratios=(3, 1), layout="constrained")
plot_components(path, above)
above.set_title(f"{len(path.turning_points)} turning points", fontsize="medium")
plot_steps(path, below)
