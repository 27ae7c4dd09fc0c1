"""The length of a path: Romberg's extrapolation of chords between refined points."""

from itertools import pairwise

import numpy as np

from continuation import refine


def length(homotopy, path):
    total = 0.0
    for begin, end in pairwise(np.unique(path.arclength)):
        points = np.array([refine(homotopy, path, s, 1e-12) for s in np.linspace(begin, end, 17).tolist()])
        chords = [np.linalg.norm(np.diff(points[::k], axis=0), axis=1).sum() for k in (16, 8, 4, 2, 1)]
        for k in range(1, 5):
            chords = [fine + (fine - coarse) / (4.0**k - 1.0) for coarse, fine in pairwise(chords)]
        total += chords[0]
    return total
