"""
Few points, an accurate curve
=============================

Between its points a path is a cubic, good to a few digits. Where a picture needs more, points are added, each corrected
onto the path, until the curve is as accurate as was asked for.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from problems.bifurcation import Bratu1D

homotopy = Bratu1D(60)
path = continuation.trace(homotopy)
figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
for name, curve in (
    ("as traced", path),
    ("accuracy 1e-3", path.refined(homotopy, 1e-3)),
    ("accuracy 1e-6", path.refined(homotopy, 1e-6)),
):
    s = np.linspace(0.0, curve.arclength[-1], 300)
    residual = [np.abs(homotopy.residual(u[:-1], u[-1])).max() + 1e-16 for u in curve(s)]
    axes.semilogy(s, residual, label=f"{name}: {len(curve)} points")
axes.set(xlabel="arclength", ylabel="residual of the curve")
axes.legend(frameon=False)
