"""The noise of a residual: what stays of its differences however near samples are, and what it does not tell apart."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from continuation.arrays import Array

DISTINCT_ULPS = 64.0
"""Units in the last place between two samples: what rounds their places is then a small part of their difference."""

NOISE_PLACES = np.array([0.0, 1.13, 1.92, 3.07, 4.21, 4.98, 6.09, 7.16, 7.94])
"""Where on a line samples are taken. At even places rounding to a grid leaves one linear function in six linear: of 150
rings that are zero by symmetry 17 had no noise then, and no scale."""


def _divided_differences(places: Array, order: int) -> Array:
    """All of one order on neighbouring places, as rows of unit length; of smooth functions they leave little."""
    rows = np.zeros((places.size - order, places.size))
    for k, row in enumerate(rows):
        some = places[k : k + order + 1]
        row[k : k + order + 1] = 1.0 / (np.subtract.outer(some, some) + np.eye(order + 1)).prod(axis=1)
    unit: Array = rows / np.linalg.norm(rows, axis=1)[:, None]
    return unit


_FOURTH = _divided_differences(NOISE_PLACES, 4)

NOISE_REACH, NOISE_FINER, NOISE_TRIES = 1e-5, 1e-3, 3
"""The samples' distance, in lengths in which a path may turn, and by what it is divided until the differences no longer
shrink with it: a thousandth makes a smooth fourth difference 1e12 times as small."""

NOISE_STEADY = 30.0
"""What is noise at two distances agrees to this factor: each is the largest of five samples of it."""

WIDENED, NOTHING_LEFT, ENDLESS = 4.0, 1e-24, 1e150
"""A way along which the equations hold to round-off is found to this factor, from a length that moves no digit of a
float to one that has no end."""


def noise_along(residual: Callable[[Array], Array], u: Array, w: Array, here: Array) -> Array:
    """The noise of each equation, shape (N,): what stays of its differences along w however near the samples are.

    Round-off of terms that do not move with u is part of it, and so is what an inner solver or a measurement leaves
    (More and Wild, Estimating computational noise, SIAM J. Sci. Comput. 33, 2011).

    `u`, `w` of shape (N + 1,): w is a way on which the function may change. `here`, of shape (N,): residual(u).
    """
    least, steady = np.full(here.size, np.inf), np.zeros(here.size, dtype=bool)
    near = float(np.median((np.spacing(np.abs(u)) / np.abs(w))[w != 0.0]))
    for k in range(NOISE_TRIES):
        h = max(NOISE_REACH * NOISE_FINER**k, DISTINCT_ULPS * near)
        samples = np.stack([here, *(residual(u + t * h * w) for t in NOISE_PLACES[1:])])
        found = np.abs(_FOURTH @ samples).max(axis=0)
        # A difference that vanishes says nothing: samples in single precision, or a few last places apart, are alike.
        found[found == 0.0] = np.inf
        now = (least <= NOISE_STEADY * found) & (least < np.inf)
        least = np.where(steady, least, np.minimum(least, found))
        steady |= now
        if steady.all():
            break
    # What still shrinks is no noise yet.
    return np.where(steady & (least < np.inf), least, 0.0)


def allowed_along(
    residual: Callable[[Array], Array], u: Array, way: Array, allowed: Array, begin: float = 1.0
) -> float:
    """How far along a way a residual stays within what is allowed of it, to a factor of WIDENED above.

    0 or ENDLESS if it nowhere does, or everywhere. The next length is where the power of the length comes to one that
    the last two too long ones show. `u`, `way` of shape (N + 1,); `allowed`, of shape (N,); `begin`: a first guess.
    """
    low, high, over, power = 0.0, np.inf, np.inf, 2.0
    length, factor, allowed = begin, WIDENED, np.maximum(allowed, np.finfo(float).tiny)
    while high > WIDENED * low and NOTHING_LEFT < length < ENDLESS:
        try:
            found = float((np.abs(residual(u + length * way)) / allowed).max())
        except Exception:
            # Nobody asked for H there: what it raises beyond its domain is shown by the step that needs that point.
            found = np.inf
        if found <= 1.0:  # not so where it is NaN
            low, length, factor = length, length * factor, factor * factor
            length = min(length, math.sqrt(low * high))
            continue
        if found < over < np.inf:
            power = max(math.log(over / found) / math.log(high / length), 1.0)
        high, over = length, found if found == found else np.inf
        length = 0.5 * high * over ** (-1.0 / power) if over < np.inf else high / factor**2
        length = max(min(length, 0.5 * high), math.sqrt(low * high))
    return min(high, ENDLESS) if low else 0.0
