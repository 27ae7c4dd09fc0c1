"""Judges points of many small dense LCPs together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.proof.certificate import ROUND_OFF
from problems.lcp.proof.compensated import LARGEST_TERMS, error_bound, summed
from problems.lcp.proof.off import DROWNED
from problems.lcp.proof.pieces import drift, identity, inverses
from problems.lcp.proof.verdict import LARGEST_DECIDED

POINT_CORRECTIONS = 2
"""Corrections with w in twice the working precision."""


def judged(
    A: Array, q: Array, active: NDArray[np.bool_], tolerance: float
) -> tuple[NDArray[np.bool_], Array, Array, Array]:
    """Correct points of faces in twice the working precision.

    `A`, (k, n, n), `q`, (k, n), `active`, (k, n): problems and faces. Returns which points solve their problem (False
    decides nothing), the points, (k, n), residuals and relative residuals, (k,), as in `Certificate`.
    """
    n = q.shape[1]
    block = np.where(active[:, :, None] & active[:, None, :], A, identity(n))
    inverse = inverses(block)
    by_columns, x, w = np.ascontiguousarray(A.transpose(2, 0, 1)), np.zeros_like(q), q
    for _ in range(1 + POINT_CORRECTIONS):
        moved = x - np.where(active, (inverse @ np.where(active, w, 0.0)[..., None])[..., 0], 0.0)
        x = np.where(np.isfinite(moved).all(axis=1, keepdims=True), np.maximum(moved, 0.0), x)
        total, lost, size = summed(by_columns, x.T[:, :, None], q)
        w = total + lost
        relative = w / np.where(size > 0.0, size, 1.0)
        off = np.abs(np.where(x > 0.0, relative, np.minimum(relative, 0.0)))
        worst = off.max(axis=1)
        if (worst <= ROUND_OFF).all():
            break
    solves: NDArray[np.bool_] = (worst <= min(ROUND_OFF, tolerance)) & ~(off * size > DROWNED * np.abs(q)).any(axis=1)
    # Other rows need scaling.
    solves &= (size.max(axis=1) <= LARGEST_TERMS) & ((size >= 1.0 / LARGEST_TERMS).all(axis=1))
    if n <= LARGEST_DECIDED:
        on, bound = x > 0.0, error_bound(w, size, n + 1)
        there, left, most = np.where(on, [x, np.abs(w) + bound, size], [[[1.0]], [[0.0]], [[1.0]]])
        defect, moved = drift(block, inverse, there, left, most, x.max(axis=1, keepdims=True))
        near = (defect < 0.5) & (moved < 0.2)
        clear = (on == active) & near & (on | (w - bound > 4.0 * moved.max(axis=1, keepdims=True) * size))
        solves &= clear.all(axis=1) | (~x.any(axis=1) & (q.min(axis=1) >= 0.0))
    return solves, x, np.abs(np.minimum(x, w)).max(axis=1), worst
