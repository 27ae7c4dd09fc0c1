"""Floats with rounding bounds exclude most complementary pieces that hold no solution.

Let R be an approximate inverse of a piece's block B with |I - R B| <= d < 1. Then its equations have one solution,
within |R r| / (1 - d) of a point with residual r (maximum norm). A sign that is wrong by more excludes the piece.

References
----------
Rump, Acta Numerica 19, 2010, section 10.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv

from continuation.arrays import EPS, Array
from problems.lcp.data.problem import BETWEEN, LOWER, UPPER, MixedLCP

TOGETHER = 1024
"""Pieces in one array: a few megabytes."""

SUM_OF_TERMS_ROUNDING = 4.0 * EPS
"""Over twice the error of a sum of k + 4 terms, per k + 4 (Higham, section 3.5)."""

SMALLEST_NORMAL = float(np.finfo(float).tiny)

States = NDArray[np.int8]


def doubtful(problem: MixedLCP, states: States) -> NDArray[np.bool_]:
    """Which pieces may hold a solution, for `states` of shape (number, n): -1 at the lower bound, 0 between, 1 at the
    upper.
    """
    A: Array = problem.A.toarray() if sp.issparse(problem.A) else problem.A
    asked = _signs_allow(A, problem.q, states == BETWEEN) if problem.standard else np.ones(len(states), dtype=bool)
    left, bounds = asked.nonzero()[0], None if problem.standard else (problem.lower, problem.upper)
    with np.errstate(all="ignore"):
        for k in range(0, left.size, TOGETHER):
            part = left[k : k + TOGETHER]
            asked[part] = in_doubt(A, problem.q, states[part], bounds)
    return asked


@lru_cache(maxsize=16)
def all_faces(n: int) -> NDArray[np.bool_]:
    """All active sets, shape (2^n, n), read-only."""
    faces: NDArray[np.bool_] = (np.arange(2**n)[:, None] >> np.arange(n) & 1).astype(bool)
    faces.flags.writeable = False
    return faces


def _signs_allow(A: Array, q: Array, inside: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Faces that no row excludes by signs alone."""
    support = inside.astype(float)
    rises, falls = support @ (A > 0.0).T > 0.0, support @ (A < 0.0).T > 0.0
    forbidden = (~rises & (q < 0.0)) | (inside & ~falls & (q > 0.0))
    return np.asarray(~forbidden.any(axis=1))


def in_doubt(A: Array, q: Array, states: States, bounds: tuple[Array, Array] | None = None) -> NDArray[np.bool_]:
    """Which pieces, of one problem or one each, may hold a solution."""
    n = states.shape[1]
    sizes, one, ones = np.abs(A), identity(n), np.ones(n)
    unit = (n + 4) * SUM_OF_TERMS_ROUNDING
    between = states == BETWEEN
    B = np.where(between[:, :, None] & between[:, None, :], A, one)
    fixed, known = q, np.abs(q)
    if bounds is not None:
        ends = np.where(states == LOWER, bounds[0], np.where(states == UPPER, bounds[1], 0.0))
        fixed, known = q + _times(A, ends), known + _times(sizes, np.abs(ends))
    right = np.where(between, -fixed, 0.0)
    R = inverses(B)
    x = np.where(between, _times(R, right), 0.0)
    size, block = np.abs(R), np.abs(B)
    defect = np.abs(R @ B - one) + unit * (size @ block)
    d = np.maximum.reduce(defect @ ones, axis=1) * (1.0 + unit)
    lost = np.where(between, unit * known, 0.0) + unit * (np.abs(right) + _times(block, np.abs(x))) + SMALLEST_NORMAL
    off = _times(size, np.abs(right - _times(B, x)) + lost)
    # SMALLEST_NORMAL exceeds underflow losses.
    off = np.maximum.reduce(off, axis=1)[:, None] * (1.0 + unit) / (1.0 - d[:, None]) + SMALLEST_NORMAL
    whole = x if bounds is None else np.where(between, x, ends)
    w = q + _times(A, whole)
    terms = np.abs(q) + _times(sizes, np.abs(whole))
    unsure = unit * terms + off * _times(sizes, between.astype(float)) * (1.0 + unit) + SMALLEST_NORMAL
    if bounds is None:
        wrong = np.where(between, x + off, w + unsure) < 0.0
    else:
        low, high = bounds
        wrong = between & ((x + off < low) | (x - off > high))
        wrong_w = ((states == LOWER) & (w + unsure < 0.0)) | ((states == UPPER) & (w - unsure > 0.0))
        wrong |= (low < high) & wrong_w
    # Comparisons with NaN are false.
    excluded = (d < 0.5) & (off[:, 0] < np.inf) & np.logical_or.reduce(wrong, axis=1)
    asked: NDArray[np.bool_] = ~excluded
    return asked


def drift(B: Array, R: Array, x: Array, left: Array, size: Array, most: Any) -> tuple[Array, Array]:
    """Bound y with B y = B x - left for x > 0, one or a stack: |y - x| <= m x / (1 - d) if d < 1; B is then
    nonsingular.

    Returns |I - R B| x / x, whose maximum is d, and |R| left / x, whose maximum is m. `size` bounds |B| x, `most`
    bounds x.
    """
    n, sizes = x.shape[-1], np.abs(R)
    # Twice the rounding of the product (Higham, section 3.5), and what underflow loses.
    lost = 2.0 * (n + 4) * EPS * _times(sizes, size) + n * n * SMALLEST_NORMAL * (1.0 + most)
    return (_times(np.abs(R @ B - identity(n)), x) + lost) / x, _times(sizes, left) / x


def _times(A: Array, v: Array) -> Array:
    product: Array = A.dot(v.T).T if A.ndim == 2 else (A @ v[:, :, None])[:, :, 0]
    return product


@lru_cache(maxsize=32)
def identity(n: int) -> Array:
    """The read-only identity."""
    one = np.eye(n)
    one.flags.writeable = False
    return one


def inverses(B: Array) -> Array:
    """Approximate inverses, NaN for singular matrices; for one matrix LAPACK is three times as fast."""
    if B.ndim == 2:
        found, singular = dgesv(B, identity(len(B)))[2:]
        return np.full_like(B, np.nan) if singular else np.asarray(found)
    try:
        return np.asarray(np.linalg.inv(B))
    except np.linalg.LinAlgError:
        regular = np.linalg.slogdet(B)[0] != 0.0
        R = np.full_like(B, np.nan)
        R[regular] = np.linalg.inv(B[regular])
        return R
