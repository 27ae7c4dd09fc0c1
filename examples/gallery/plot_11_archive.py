"""
An archive, read with other tools
=================================

An archive is HDF5 and netCDF at once. On the left h5py alone draws a path, on the right the library does.
"""

import tempfile
from pathlib import Path

import h5py
import matplotlib.pyplot as plt

import continuation
from continuation.archive import open_archive
from problems.bifurcation import ExponentialCosine

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "run.h5"
    continuation.trace(ExponentialCosine(4), archive=file)
    with h5py.File(file) as plain:
        rows = plain["committed_points"][()]
        lam, y = plain["parameter"][:rows], plain["y"][:rows]
    with open_archive(file) as archive:
        path = archive.path(0)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
left.plot(lam, y[:, 0], ".-", linewidth=0.6)
left.set_title("points of the file", fontsize="medium")
path.plot(right, components=[0], legend=False)
right.set_title("the path, a curve", fontsize="medium")
print(path)
