"""The exponential-cosine path, exactly.

The path is a graph over S = sum_j x_j: lam(S) = S / sum_k exp(cos kS) and x_k = lam(S) exp(cos kS).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from continuation.arrays import Array

_SAMPLES = 400
"""Samples of S a unit and a harmonic, between which a root of lam - 1 or lam' is bracketed."""


def _derivatives(n: int, S: Array) -> tuple[Array, Array]:
    """The path u = (x, lam) and its derivative in S, each of shape (..., n + 1)."""
    k = np.arange(1.0, n + 1)
    angles = np.multiply.outer(S, k)
    e = np.exp(np.cos(angles))
    e1 = -k * np.sin(angles) * e
    total, total1 = e.sum(axis=-1), e1.sum(axis=-1)
    # Differentiating lam * total = S.
    lam = S / total
    lam1 = (1.0 - lam * total1) / total
    x, x1 = lam[..., None] * e, lam1[..., None] * e + lam[..., None] * e1
    return np.concatenate((x, lam[..., None]), axis=-1), np.concatenate((x1, lam1[..., None]), axis=-1)


def curve(n: int, S: Array) -> Array:
    """Points (x_1, ..., x_n, lam) at `S`, shape (..., n + 1)."""
    return _derivatives(n, np.asarray(S, dtype=float))[0]


def end(n: int) -> float:
    """S_end, the first S with lam(S) = 1; the end of the path is ``curve(n, end(n))``."""
    # There S = sum_k exp(cos kS) <= n e, which bounds the search.
    return float(_roots(lambda S: _derivatives(n, S)[0][..., -1] - 1.0, n, n * np.e + 1.0)[0])


def turning_points(n: int) -> Array:
    """Rows (x_1, ..., x_n, lam) where lam'(S) = 0 before the end, in the order of the path, shape (k, n + 1)."""
    return curve(n, _roots(lambda S: _derivatives(n, S)[1][..., -1], n, end(n)))


def _roots(function: Callable[[Array], Array], n: int, stop: float) -> Array:
    """Every sign change of `function` on (0, stop), to round-off."""
    S = np.linspace(0.0, stop, int(_SAMPLES * n * stop))
    positive = function(S) > 0.0
    brackets = np.flatnonzero(positive[:-1] != positive[1:])
    return np.array([brentq(lambda s: float(function(np.array(s))), S[i], S[i + 1], xtol=1e-15) for i in brackets])
