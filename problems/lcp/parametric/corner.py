"""Corners where several switches vanish."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from scipy.linalg import null_space

from continuation.arrays import Array
from continuation.kinks.pivots import PIVOTS_PER_SWITCH, ZERO_COMPONENT, Ray
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.almost import Ended
from problems.lcp.pivoting.starts import covering

LARGEST_LISTED = 10
"""Most switches with which all 2^m pieces are tried (30 ms), and largest order for all faces (0.1 s)."""


def rays(S: Array, r: Array) -> list[Ray]:
    """All rays that are alone on their piece, including that of arrival; one of many switches, by Lemke's method.

    `S`, (m, m), `r`, (m,): the path arrived with e' = 1 and u' = r <= 0.
    """
    m = r.size
    if m > LARGEST_LISTED:
        grown = _a_solution(S, r)
        return [] if grown is None else [Ray(grown, 1.0)]
    unit = np.maximum(np.abs(r), np.abs(S).max(axis=1, initial=0.0))
    unit = np.where(unit > 0.0, unit, 1.0)
    whole = np.column_stack([S / unit[:, None], r / unit])
    wide = np.abs(whole[:, :m]).max(axis=0, initial=0.0)
    wide = np.where(wide > 0.0, wide, 1.0)
    whole[:, :m] /= wide
    found: list[Array] = []
    for size in range(m + 1):
        for active in combinations(range(m), size):
            columns = [*active, m]
            rest = [i for i in range(m) if i not in active]
            block = whole[np.ix_(list(active), columns)]
            kernel = null_space(block, rcond=ZERO_COMPONENT) if active else np.ones((1, 1))
            if kernel.shape[1] != 1:
                continue
            for ray in (kernel[:, 0], -kernel[:, 0]):
                signs = np.append(ray[:size], whole[np.ix_(rest, columns)] @ ray)
                if (signs < -ZERO_COMPONENT).any():
                    continue
                along = np.zeros(m + 1)
                along[columns] = ray / np.abs(ray).max()
                along[:m] = np.where(along[:m] > ZERO_COMPONENT, along[:m], 0.0)
                if not any(np.abs(along - one).max() <= 1e3 * ZERO_COMPONENT for one in found):
                    found.append(along)
    return [Ray(along[:m] / wide, float(along[m])) for along in found]


def _a_solution(S: Array, r: Array) -> Array | None:
    path = covering(LCP(S, r), np.ones(r.size))
    if path is None or path.run(PIVOTS_PER_SWITCH * r.size) is not Ended.REACHED:
        return None
    grown = np.zeros(r.size)
    active = np.flatnonzero(path.active)
    grown[active] = np.linalg.solve(S[np.ix_(active, active)], -r[active])
    return grown
