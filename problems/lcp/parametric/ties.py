"""Where a walk comes to a corner: one switch is a pivot, several at once a small LCP whose solutions are all rays."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.kinks.pivots import Ray, way
from problems.lcp.parametric.corner import LARGEST_LISTED, rays
from problems.lcp.parametric.walk import FLAT, SLOW_RATE, Walk


@frozen(eq=False)
class Corner:
    """What happened at a corner.

    Attributes
    ----------
    switches : tuple of int
        The indices of the pairs at a corner of their graphs.
    directions : list of Array of shape (n + 1,)
        Of all rays, where several switches vanish, and not too many.
    dead : bool
        Whether none leaves but the one that was come on.
    """

    switches: tuple[int, ...]
    directions: list[Array]
    dead: bool = False


def turn(walk: Walk) -> Corner | None:
    """Take the corner found; what it was, or None where no way on was found."""
    if walk.tied.size == 1:
        i = int(walk.tied[0])
        walk.pivot(i)
        return Corner((i,), [])
    return _turn_tied(walk)


def _turn_tied(walk: Walk) -> Corner | None:
    tied, low = walk.tied, walk.low
    walk.degenerate = True
    S, r, along = small(walk)
    on = way(S, r)
    edges = rays(S, r) if tied.size <= LARGEST_LISTED else []
    found = [_direction(ray, along) for ray in edges]
    onward = [ray for ray in edges if not ray.back]
    if on is None or on.ray.back:
        if not onward:
            # That no other ray leaves may be said if the one come on is found.
            return Corner(tuple(tied.tolist()), found, dead=True) if edges else None
        walk.switch_tied(onward[0].grown > 0.0)
        aim(walk, along @ np.append(onward[0].grown, onward[0].driven), walk.step)
        return Corner(tuple(tied.tolist()), found)
    walk.switch_tied(np.isin(np.arange(tied.size), on.switched))
    walk.drive(int(tied[on.driver]), bool(low[on.driver]))
    return Corner(tuple(tied.tolist()), found)


def aim(walk: Walk, direction: Array, step: float = 0.0) -> None:
    """Go on along a direction from where so long a step leads: driven by t, or by the x that moves most."""
    n = walk.problem.n
    moves_x = walk.stairs.moves_x[walk.state.astype(np.intp) + 1, np.arange(n)]
    moving = np.abs(np.where(np.append(moves_x, True), direction, 0.0))
    driver = n if moving[n] > SLOW_RATE * moving.max() else int(np.argmax(moving))
    walk.driver, walk.sign = driver, float(np.sign(direction[driver]))
    walk.value = float(walk.u[0, driver] + step * walk.u[1, driver])


def small(walk: Walk) -> tuple[Array, Array, Array]:
    """S and r of the small LCP, and how (x, t) moves with each of its variables."""
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
        # Its w moves with the corner that it left.
        left[j] = (walk.d[j] - walk.shares[j]) * along[n, :m]
    rates = np.where(moving[:, None], along[tied, :m], left[tied])
    rates = np.column_stack([rates, walk.dy[tied]])
    rates -= walk.slopes[np.where(walk.low, 0, 1), tied][:, None] * along[n]
    rates *= sign[:, None]
    size = np.append(np.abs(along[:, :m]).max(axis=0, initial=0.0), walk.scale[1])
    rates[np.abs(rates) <= FLAT * size * walk.terms[tied][:, None]] = 0.0
    fixed = np.flatnonzero(~moving)
    along[tied[fixed], fixed] = sign[fixed]
    rates[:, m] = np.minimum(rates[:, m], 0.0)
    return rates[:, :m], rates[:, m], along


def snap(walk: Walk, pairs: tuple[int, ...]) -> None:
    """Put the x of pairs that are at a corner of their graphs there exactly: some are basic, and rounded."""
    at = list(pairs)
    corners = walk.stairs.corner_x[:, at]
    walk.u[0, at] = corners[np.abs(walk.u[0, at] - corners).argmin(axis=0), np.arange(len(at))]


def _direction(ray: Ray, along: Array) -> Array:
    direction: Array = along @ np.append(ray.grown, ray.driven)
    return direction / np.linalg.norm(direction)
