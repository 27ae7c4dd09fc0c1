"""The length of a path."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from continuation.arrays import SIX_DIGITS
from continuation.auditing.retrace import refine
from continuation.path import Path
from continuation.path.path import require_path

HALVINGS = 4
"""Halvings of a part of a step, whose chords Romberg's rule extrapolates, before the part is divided."""

AGREEMENT = 1e-10
"""Difference of the last two extrapolations, relative to the length so far: nine digits are then right."""


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
    require_path(path)
    knots = np.unique(path.arclength).tolist()
    total, parts = 0.0, [*pairwise(knots)][::-1]
    while parts:
        begin, end = parts.pop()
        places = np.linspace(begin, end, 2**HALVINGS + 1).tolist()
        points = np.array([refine(homotopy, path, s, 1e-12) for s in places])
        sums = [np.linalg.norm(np.diff(points[:: 2**k], axis=0), axis=1).sum() for k in range(HALVINGS, -1, -1)]
        for k in range(1, HALVINGS):
            sums = [fine + (fine - coarse) / (4.0**k - 1.0) for coarse, fine in pairwise(sums)]
        last = sums[1] + (sums[1] - sums[0]) / (4.0**HALVINGS - 1.0)
        # Parts of a millionth end at a corner.
        if abs(last - sums[1]) > AGREEMENT * (total + last) and end - begin > SIX_DIGITS * knots[-1]:
            middle = places[len(places) // 2]
            parts += [(middle, end), (begin, middle)]
        else:
            total += float(last)
    return total
