"""
Both directions, within a box
=============================

From one start the path is followed both ways, each until it leaves the box. The two halves are one path, which can be
cut, turned round and saved.
"""

import matplotlib.pyplot as plt

import continuation
from problems.bifurcation import FreudensteinRoth

path = continuation.trace_both(FreudensteinRoth(), target=None, box={"lam": (-3.0, 3.0)})
print(path)
print(path.message)
print(path[3:9])

figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
path.plot(axes, value=0)
