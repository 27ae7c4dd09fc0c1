"""The noise of a residual: what stays of its differences however near the samples are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from continuation.arrays import Array

DISTINCT_ULPS = 64.0
"""Units in the last place between two samples: what rounds their places is then a small part of their difference."""

NOISE_SAMPLES = 7
"""Samples on a line: three fourth differences, of which a smooth function leaves the fourth power of their distance."""

NOISE_REACH, NOISE_FINER, NOISE_TRIES = 1e-5, 1e-3, 3
"""The samples' distance, in lengths in which a path may turn, and by what it is divided until the differences no longer
shrink with it: a thousandth makes a smooth fourth difference 1e12 times as small."""

NOISE_STEADY = 30.0
"""What is noise at two distances agrees to this factor: each is the largest of three samples of it."""


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
        samples = np.stack([here, *(residual(u + j * h * w) for j in range(1, NOISE_SAMPLES))])
        # A fourth difference of noise of variance 1 has the variance 70.
        found = np.abs(np.diff(samples, 4, axis=0)).max(axis=0) / np.sqrt(70.0)
        now = least <= NOISE_STEADY * found
        least = np.where(steady, least, np.minimum(least, found))
        steady |= now
        if steady.all():
            break
    return least
