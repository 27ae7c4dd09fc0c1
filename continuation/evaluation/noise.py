"""Noise of a residual: differences that do not shrink with the samples' distance."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from continuation.arrays import Array

NOISE_LOOKS = 4.0
"""Factor from one random sample to the largest of many."""

LOOK = 64.0
"""Least distance of samples, in ulps: the rounding of their places is then small."""

NOISE_PLACES = np.array([0.0, 1.13, 1.92, 3.07, 4.21, 4.98, 6.09, 7.16, 7.94])
"""Sample parameters. Even spacing hid the noise of 17 of 150 rings that are zero by symmetry."""


def _divided_differences(places: Array, order: int) -> Array:
    rows = np.zeros((places.size - order, places.size))
    for k, row in enumerate(rows):
        some = places[k : k + order + 1]
        row[k : k + order + 1] = 1.0 / (np.subtract.outer(some, some) + np.eye(order + 1)).prod(axis=1)
    unit: Array = rows / np.linalg.norm(rows, axis=1)[:, None]
    return unit


_FOURTH = _divided_differences(NOISE_PLACES, 4)

NOISE_REACH, NOISE_FINER, NOISE_TRIES = 1e-5, 1e-3, 3
"""First sample distance, in lengths of a turn; its factor, by which smooth fourth differences shrink 1e12 times; most
distances."""

NOISE_STEADY = 30.0
"""Largest ratio of noise at two distances, each the largest of five samples."""

WIDENED, ENDLESS = 4.0, 1e150
"""Accuracy factor of `allowed_along`'s lengths, and the longest."""


def noise_along(residual: Callable[[Array], Array], u: Array, w: Array, here: Array, enough: Array) -> Array:
    """The noise of each equation, shape (N,): fourth differences along w that do not shrink with the distance.

    Method: More and Wild, Estimating computational noise, SIAM J. Sci. Comput. 33, 2011. `u`, `w` have shape (N + 1,).
    `here`: residual(u). `enough`, shape (N,): smaller noise need not be steady.
    """
    least, noise, steady = np.full(here.size, np.inf), np.zeros(here.size), np.zeros(here.size, dtype=bool)
    near = float(np.median((np.spacing(np.abs(u)) / np.abs(w))[w != 0.0]))
    for k in range(NOISE_TRIES):
        h = max(NOISE_REACH * NOISE_FINER**k, LOOK * near)
        samples = np.stack([here, *(residual(u + t * h * w) for t in NOISE_PLACES[1:])])
        found = np.abs(_FOURTH @ samples).max(axis=0)
        # Equal samples are no evidence.
        found[(samples == here).all(axis=0)] = np.inf
        now = (least <= NOISE_STEADY * found) & (least < np.inf) | (found <= enough)
        # Of differences that no longer shrink, the nearer contain less of the function, even if larger.
        noise = np.where(now & ~steady, np.where(found < np.inf, found, least), noise)
        least, steady = np.minimum(least, found), steady | now
        if steady.all():
            break
    return noise


def allowed_along(
    residual: Callable[[Array], Array], u: Array, way: Array, allowed: Array, begin: float = 1.0
) -> float:
    """How far along `way` a residual stays within `allowed`, up to a factor WIDENED; at most ENDLESS.

    Power laws extrapolate lengths, from `begin`.
    """
    low, high, over, power = 0.0, np.inf, np.inf, 2.0
    length, factor, allowed = begin, WIDENED, np.maximum(allowed, np.finfo(float).tiny)
    while high > WIDENED * low and 1.0 / ENDLESS < length < ENDLESS:
        try:
            found = float((np.abs(residual(u + length * way)) / allowed).max())
        except Exception:
            # H is probed beyond its domain.
            found = np.inf
        if found <= 1.0:  # false for NaN
            low, length, factor = length, length * factor, factor * factor
            length = min(length, math.sqrt(low * high))
            continue
        if found < over < np.inf:
            power = max(math.log(over / found) / math.log(high / length), 1.0)
        high, over = length, found if found == found else np.inf
        length = 0.5 * high * over ** (-1.0 / power) if over < np.inf else high / factor**2
        length = max(min(length, 0.5 * high), math.sqrt(low * high))
    return min(high, ENDLESS) if low else 0.0
