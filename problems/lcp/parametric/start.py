"""Starts of walks."""

from __future__ import annotations

import math

import numpy as np

from continuation.arrays import Array
from continuation.kinks.pivots import ZERO_COMPONENT
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.parametric.corner import rays
from problems.lcp.parametric.stairs import Stairs
from problems.lcp.parametric.ties import aim, small
from problems.lcp.parametric.walk import Walk


def from_ray(problem: MixedLCP, d: Array, level: Array, sign: float) -> Walk:
    """The walk from t = +inf (sign = -1), or -inf; `ValueError` if the point nearest to zero is no solution for large
    t.
    """
    state: State = np.where(
        level > 0.0, 0, np.where(np.isfinite(problem.lower), -1, np.where(np.isfinite(problem.upper), 1, 0))
    ).astype(np.int8)
    walk = Walk(problem, d, Stairs.of(problem, level), state, problem.n, 0.0, -sign)
    walk.locate()
    gaps, rates = walk.gaps.ravel(), walk.rates.ravel()
    wrong = ((rates < 0.0) | ((rates == 0.0) & (gaps < 0.0))) & np.isfinite(gaps)
    if wrong.any():
        i = int(np.argmax(wrong)) % problem.n
        raise ValueError(
            f"t: no ray begins at t = {-sign * math.inf}, where x = {walk.u[0, i]:g} would have to solve row {i}: "
            "expected a covering vector d, or a finite t to begin at"
        )
    far = (rates > 0.0) & np.isfinite(gaps)
    last = float((-gaps[far] / rates[far]).max(initial=0.0))
    walk.value, walk.sign = -sign * (last + max(1.0, last)), sign
    return walk


def from_solution(
    problem: MixedLCP, d: Array, level: Array, x: Array, t: float, sign: float, ray: Array | None = None
) -> Walk | None:
    """The walk from a solution along the ray nearest to `ray`, or with t going by `sign`; None without such a ray.

    Raises `SingularBasisError` if its piece holds several rays.
    """
    stairs = Stairs.of(problem, level)
    walk = Walk(problem, d, stairs, stairs.states(problem, x), problem.n, t, sign)
    walk.locate()
    walk.find_tied()
    if walk.tied.size:
        S, r, along = small(walk)
        found = rays(S, r)
        directions = [along @ np.append(one.grown, one.driven) for one in found]
        wanted = [_agreement(one, ray, sign) for one in directions]
        if not wanted or max(wanted) <= 0.0:
            return None
        best = int(np.argmax(wanted))
        walk.switch(found[best].grown > 0.0)
        aim(walk, directions[best])
        walk.locate()
    elif ray is not None and walk.u[1] @ ray < 0.0:
        walk.sign = -walk.sign
    return walk


def _agreement(direction: Array, ray: Array | None, sign: float) -> float:
    length = float(np.linalg.norm(direction))
    if ray is not None:
        return float(direction @ ray) / length
    return sign * float(direction[-1]) / length if abs(direction[-1]) > ZERO_COMPONENT * length else 0.0
