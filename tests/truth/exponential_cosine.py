"""The exponential-cosine path, exactly.

The path is a graph over S = sum_j x_j: lam(S) = S / sum_k exp(cos kS) and x_k = lam(S) exp(cos kS).
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from continuation.arrays import Array

_SAMPLES = 400
"""Samples of S a unit and a harmonic, between which a root of lam - 1 or lam' is bracketed."""


def _derivatives(n: int, S: Array) -> tuple[Array, Array, Array]:
    """The path u = (x, lam) and its first two derivatives in S, each of shape (..., n + 1)."""
    k = np.arange(1.0, n + 1)
    angles = np.multiply.outer(S, k)
    e = np.exp(np.cos(angles))
    e1 = -k * np.sin(angles) * e
    e2 = k * k * (np.sin(angles) ** 2 - np.cos(angles)) * e
    total, total1, total2 = e.sum(axis=-1), e1.sum(axis=-1), e2.sum(axis=-1)
    # Differentiating lam * total = S, once and twice.
    lam = S / total
    lam1 = (1.0 - lam * total1) / total
    lam2 = -(2.0 * lam1 * total1 + lam * total2) / total
    x = lam[..., None] * e
    x1 = lam1[..., None] * e + lam[..., None] * e1
    x2 = lam2[..., None] * e + 2.0 * lam1[..., None] * e1 + lam[..., None] * e2
    return (
        np.concatenate((x, lam[..., None]), axis=-1),
        np.concatenate((x1, lam1[..., None]), axis=-1),
        np.concatenate((x2, lam2[..., None]), axis=-1),
    )


def curve(n: int, S: Array) -> Array:
    """Points (x_1, ..., x_n, lam) at `S`, shape (..., n + 1)."""
    return _derivatives(n, np.asarray(S, dtype=float))[0]


def curvature(n: int, S: Array) -> Array:
    """Curvature of the path in the Euclidean metric of (x, lam) at `S`."""
    _, u1, u2 = _derivatives(n, np.asarray(S, dtype=float))
    square = (u1 * u1).sum(axis=-1)
    along = (u1 * u2).sum(axis=-1) / square
    curvature: Array = np.linalg.norm(u2 - along[..., None] * u1, axis=-1) / square
    return curvature


def end(n: int) -> float:
    """S_end, the first S with lam(S) = 1; the end of the path is ``curve(n, end(n))``."""
    # There S = sum_k exp(cos kS) <= n e, which bounds the search.
    return float(_roots(lambda S: _derivatives(n, S)[0][..., -1] - 1.0, n, n * np.e + 1.0)[0])


def turning_points(n: int) -> Array:
    """Rows (x_1, ..., x_n, lam) where lam'(S) = 0 before the end, in the order of the path, shape (k, n + 1)."""
    return curve(n, _roots(lambda S: _derivatives(n, S)[1][..., -1], n, end(n)))


def arclength(n: int) -> float:
    """Length of the path from the origin to its end, in the Euclidean metric of (x, lam)."""
    breaks = np.linspace(0.0, end(n), 8 * n + 1)

    def speed(S: float) -> float:
        return float(np.linalg.norm(_derivatives(n, np.array(S))[1]))

    return float(sum(quad(speed, a, b, epsabs=1e-13, epsrel=1e-13)[0] for a, b in pairwise(breaks)))


def _roots(function: Callable[[Array], Array], n: int, stop: float) -> Array:
    """Every sign change of `function` on (0, stop), to round-off."""
    S = np.linspace(0.0, stop, int(_SAMPLES * n * stop))
    positive = function(S) > 0.0
    brackets = np.flatnonzero(positive[:-1] != positive[1:])
    return np.array([brentq(lambda s: float(function(np.array(s))), S[i], S[i + 1], xtol=1e-15) for i in brackets])
