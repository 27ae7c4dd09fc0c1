"""Corners of a walk: a pivot, or a small LCP."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import SIX_DIGITS, Array
from continuation.kinks.pivots import way
from problems.lcp.parametric.corner import LARGEST_LISTED, rays
from problems.lcp.parametric.walk import FLAT, Walk


@frozen(eq=False)
class Corner:
    """A corner of a walk.

    `switches`: pairs that switch. `directions`: all rays, shape (n + 1,), if several pairs do. `dead`: whether only the
    ray of arrival exists.
    """

    switches: tuple[int, ...]
    directions: list[Array]
    dead: bool = False


def turn(walk: Walk, step: float) -> Corner | None:
    """Take the corner after this step; None without a way on."""
    found: list[Array] = []
    switched = np.ones(1, dtype=bool)
    driver, switches = 0, tuple(walk.tied.tolist())
    if len(switches) > 1:
        S, r, along = small(walk)
        on, edges = way(S, r), rays(S, r) if len(switches) <= LARGEST_LISTED else []
        found = [along @ np.append(ray.grown, ray.driven) for ray in edges]
        if on is None or on.ray.back:
            onward = [k for k, ray in enumerate(edges) if not ray.back]
            if onward:
                walk.switch(edges[onward[0]].grown > 0.0)
                aim(walk, found[onward[0]], step)
                return Corner(switches, found)
            return Corner(switches, found, dead=True) if edges else None
        switched, driver = np.isin(np.arange(len(switches)), on.switched), on.driver
    walk.switch(switched)
    walk.drive(int(walk.tied[driver]), bool(walk.low[driver]))
    return Corner(switches, found)


def aim(walk: Walk, direction: Array, step: float = 0.0) -> None:
    """Continue along a direction, driven by t or the fastest x."""
    n = walk.problem.n
    moves_x = walk.stairs.moves_x[walk.state.astype(np.intp) + 1, np.arange(n)]
    moving = np.abs(np.where(np.append(moves_x, True), direction, 0.0))
    driver = n if moving[n] > SIX_DIGITS * moving.max() else int(np.argmax(moving))
    walk.driver, walk.sign = driver, float(np.sign(direction[driver]))
    walk.value = float(walk.u[0, driver] + step * walk.u[1, driver])


def small(walk: Walk) -> tuple[Array, Array, Array]:
    """S and r of the small LCP, and the derivatives of (x, t)."""
    n, basis, tied = walk.problem.n, walk.basis, walk.tied
    m = tied.size
    sign = np.where(walk.low, 1.0, -1.0)
    right = np.zeros((n, m), order="F")
    for k, i in enumerate(tied):
        if walk.moves_x[i]:
            right[i, k] = -sign[k]
        else:
            right[:, k] = sign[k] * walk.problem.A[:, i]
    z, left = basis.solve(right)
    along = np.zeros((n + 1, m + 1))
    along[basis.columns, :m] = z
    along[:, m] = walk.u[1]
    moving = walk.moves_x[tied]
    j = walk.driver
    if j < n and not walk.moves_x[j]:
        left[j] = (walk.d[j] - walk.shares[j]) * along[n, :m]
    rates = np.where(moving[:, None], along[tied, :m], left[tied])
    side = np.where(walk.low, 0, 1), tied
    rates = sign[:, None] * (rates - walk.slopes[side][:, None] * along[n, :m])
    size = np.abs(along[:, :m]).max(axis=0, initial=0.0)
    rates[np.abs(rates) <= FLAT * size * walk.terms[tied][:, None]] = 0.0
    fixed = np.flatnonzero(~moving)
    along[tied[fixed], fixed] = sign[fixed]
    r = walk.rates[side]
    return rates, np.where(r < -FLAT * walk.noise[1, tied], r, 0.0), along
