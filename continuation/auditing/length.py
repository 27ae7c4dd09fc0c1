"""The length of a path."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from continuation.auditing.retrace import refine
from continuation.path import Path

HALVINGS = 4
"""Halvings of a step: Romberg's extrapolation then leaves about 1e-9 of the length."""


def arclength(homotopy: Any, path: Path) -> float:
    """The Euclidean length of a traced path in (y, lam), by chords between refined points.

    Parameters
    ----------
    homotopy : Homotopy
        As traced.
    path : Path

    Raises
    ------
    ValueError
        If the path has no step.
    ArithmeticError
        If a point cannot be refined.

    References
    ----------
    Romberg's extrapolation of the trapezoidal rule (Stoer and Bulirsch, Introduction to Numerical Analysis, Section
    3.4).
    """
    total = 0.0
    for begin, end in pairwise(np.unique(path.arclength)):
        places = np.linspace(begin, end, 2**HALVINGS + 1).tolist()
        points = np.array([refine(homotopy, path, s, 1e-12) for s in places])
        sums = [np.linalg.norm(np.diff(points[:: 2**k], axis=0), axis=1).sum() for k in range(HALVINGS, -1, -1)]
        for k in range(1, HALVINGS + 1):
            sums = [fine + (fine - coarse) / (4.0**k - 1.0) for coarse, fine in pairwise(sums)]
        total += float(sums[0])
    return total
