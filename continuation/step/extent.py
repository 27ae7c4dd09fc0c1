"""Initial scales of components, from the length on which a path turns.

Results are independent of units and origin. Nonlinearity is measured with simplified Newton corrections d and e at u +
h v, v the tangent (Deuflhard, Newton Methods for Nonlinear Problems, Sections 2.1 and 5.1): the median of |d_i| / (h
|v_i|) shows how far the path turns, |e| / |d| how far the equations change. Both grow like h.
"""

from __future__ import annotations

import math

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from continuation.arrays import Array, dot, generic_vector, median
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import POINT_ULPS, Evaluator
from continuation.evaluation.noise import ENDLESS, allowed_along
from continuation.point.linearization import Linearization

TURN = 0.25
"""Nonlinearity at the extent; from 0.1 to 0.5, factorisations on twelve problems differ by a tenth."""

AROUND = 1.001
"""The search ends within this factor of TURN, then a power law follows, so that the result does not depend on the
search's start. With 1.05, shifts changed extents by a hundredth, factorisations on Bratu's problem by a factor of
two."""

POWERS = 0.5, 4.0
"""Bounds of that power: one is usual, two if the path is symmetric."""

FIRST_STEP = 0.3
"""In extents: turns by a third of TURN; controllers aim at 0.4 radians."""

SEARCH_START = 1e-3
"""First length over the distance to the target; must not jump over the first turn."""

LENGTHS_TRIED = 40
"""Limit; five are usual."""

GROWTH = 30.0
"""Largest ratio of lengths: straight beginnings show no nonlinearity."""

STRAIGHT_LENGTH = 1e30
"""Paths without target that are straight so far, relative to the start, have no scale."""

STANDSTILL = 1e-60
"""Motion below this part of the largest, in any units, counts as none."""

STILL_PIECEWISE = 1e-13
"""STANDSTILL on smooth pieces, where still components have others' round-off; units thirteen orders apart look
alike."""

SUSPECT, REPLACED = 1e-8, 0.1
"""Smaller tangent components, relative to the largest, are round-off if refinement changes them by more than
REPLACED."""

UNCERTAIN = 100.0
"""Corrections below so many times their round-off, in two samples, are ignored."""

SWEEPS = 10
"""Of Sinkhorn's iteration: a metric needs only rough units."""

OTHER_UNITS = 1e4
"""Nonlinearity of wrong units; six symmetric trunks in units of 1 gave 0.2 to 1,100."""


def initial_extent(
    evaluator: Evaluator,
    point: Linearization,
    target: float | None,
    residual: Array,
    farthest: float = np.inf,
    room: float = np.inf,
    sizes: Array | None = None,
) -> tuple[Array, Array]:
    """Motion of each component until the path turns by about TURN or meets a nearer target; and its noise.

    Parameters
    ----------
    evaluator : Evaluator
    point : Linearization
        Start, in any metric.
    target : float or None
    residual : ndarray, shape (N,)
        H at the start.
    farthest : float
        Scale without a target; finite for piecewise straight paths alone.
    room : float
        Distance along the tangent to a requested end.
    sizes : ndarray, shape (N + 1,), optional
        Component sizes; motion below their round-off counts as none.

    Returns
    -------
    extent : ndarray, shape (N + 1,)
        Positive. Still components get the others' median, in their sizes if known.
    blur : ndarray, shape (N + 1,)
        |H'^-1| times the noise in H and in u's last digits.
    """
    u, v = point.u, point.tangent
    whole, gap = np.inf, np.inf if target is None or target == point.lam else target - point.lam
    if np.isfinite(gap) and v[-1] != 0.0:
        whole = abs(gap / v[-1])
        v = v * np.sign(gap / v[-1])
    whole = whole if np.isfinite(whole) else farthest
    exactly = sizes is None and np.isinf(farthest)
    standstill, unit = STANDSTILL if exactly else STILL_PIECEWISE, np.ones_like(v) if sizes is None else sizes
    if not exactly:
        v = np.where(np.abs(v) > standstill * unit * float(np.abs(v / unit).max()), v, 0.0)
    v = _without_round_off(evaluator, point, v)
    size = np.abs(v)
    moving = size > 0.0
    length = min(whole, max(1.0, float((np.abs(u[moving]) / size[moving]).max())))
    # Nearer is safer without a target: one component changes by its own size.
    changed = np.abs(u[moving]) / size[moving]
    nearest = float(changed[changed > 0.0].min(initial=whole)) if np.isinf(whole) else whole
    # Terms that vanish at zero have no noise there.
    ahead = SEARCH_START * length if not u[:-1].any() else 0.0
    way = (nearest if np.isfinite(nearest) else length) * v
    try:
        noise = evaluator.measure_noise(u + ahead * v, way, evaluator.residual(u + ahead * v) if ahead else residual)
    except EvaluationError:
        ahead, noise = 0.0, evaluator.measure_noise(u, way, residual)
    samples = [point.approximate(signs * noise) for signs in (np.sign(generic_vector(noise.size)), 1.0)]
    # Hold the component whose relative noise is least.
    best = int(np.argmin(np.where(moving, np.abs(samples).max(axis=0) / np.where(moving, size, 1.0), np.inf)))
    blur = np.maximum(_largest([z - z[best] / v[best] * v for z in samples]), np.spacing(np.abs(u)))
    v = np.where((ahead or length) * size > UNCERTAIN * blur, v, 0.0)
    size, moving = np.abs(v), v != 0.0
    unseen = UNCERTAIN * np.maximum(_largest([_across(v, z) for z in samples]), blur)
    h = SEARCH_START * length
    begin, low, high, power = h, 0.0, np.inf, 1.0
    found, off, before = h, np.zeros_like(u), (0.0, 0.0)
    for _ in range(LENGTHS_TRIED):
        try:
            d, turned = _nonlinearity(evaluator, point, v, h, residual, unseen * max(1.0, h / (ahead or h)))
        except Exception:
            # The step that needs this point reports exceptions.
            d, turned = off, np.inf
        # At a fold only the correction moves the parameter.
        turned = max(turned, TURN * abs((h * v[-1] + d[-1]) / gap))
        if before[1] > 0.0 and 0.0 < turned < np.inf and h != before[0]:
            power = min(max(float(np.log(turned / before[1]) / np.log(h / before[0])), POWERS[0]), POWERS[1])
        before = h, turned if turned < np.inf else 0.0
        rest = GROWTH if turned <= 0.0 else float((TURN / turned) ** (1.0 / power))
        if TURN / AROUND <= turned <= AROUND * TURN:
            rest = min(rest, whole / h)
            found, off = rest * h, rest ** (power + 1.0) * d
            break
        if turned > TURN:
            high = h
        else:
            low = found = h
            off = d
            if h > STRAIGHT_LENGTH:
                # Only the start's size is left as a scale.
                found, off = begin / SEARCH_START, off * (begin / SEARCH_START / h) ** 2
                break
        h *= min(max(rest, 0.1), GROWTH)
        if not low < h < high:
            h = 0.5 * (low + high)
        h = min(h, whole)
        if high < AROUND * low:
            break
    if found > room:
        found, off = room, (room / found) ** 2 * off
    extent = np.maximum(found * size, np.abs(off)) / unit
    still = (extent <= standstill * float(extent.max())) | (extent * unit <= UNCERTAIN * blur)
    still &= ~still.all()
    extent[still] = median(extent[~still])
    extent *= unit
    if still.any() and exactly:
        extent[:-1] *= np.where(still[:-1], _units(evaluator, u, still[:-1]), 1.0)
        extent[still] *= _smaller(evaluator, point, np.where(still, extent, 0.0), residual)
    return extent, blur


def _units(evaluator: Evaluator, u: Array, still: NDArray[np.bool_]) -> Array:
    """Units of still unknowns that equalise their columns of H_y, by Sinkhorn's iteration; ones without a matrix."""
    ones = np.ones(still.size)
    H_y = evaluator.matrix(u) if still.sum() > 1 else None
    if not (isinstance(H_y, np.ndarray) or sp.issparse(H_y)):
        return ones
    squares = np.square(H_y) if isinstance(H_y, np.ndarray) else sp.csr_array(H_y).power(2)
    columns = still.astype(float)
    for _ in range(SWEEPS):
        rows = _inverse(squares @ columns)
        columns = np.where(still, _inverse(squares.T @ rows), 0.0)
    sizes = np.sqrt(columns)
    known = sizes > 0.0
    return np.where(known, sizes / median(sizes[known]), ones) if known.any() else ones


def _inverse(sums: Array) -> Array:
    return np.divide(1.0, sums, out=np.zeros_like(sums), where=sums > 0.0)


def _smaller(evaluator: Evaluator, point: Linearization, z: Array, residual: Array) -> float:
    """Factor for sizes of still components, so that H is nearly linear over them.

    Branches leave symmetric trunks in these components; if sizes were far too large, a whole branch would count as
    round-off.
    """
    h, moved = 1.0, z > 0.0
    for _ in range(LENGTHS_TRIED):
        try:
            d = point.solve(residual - evaluator.residual(point.u + h * z))
            turned = float((np.abs(d + h * z)[moved] / (h * z[moved])).max())
        except Exception:
            # As above.
            turned = np.inf
        if turned <= OTHER_UNITS:
            break
        # Second- or third-order terms matter; the root suits the latter.
        h *= max(np.sqrt(TURN / turned), TURN / GROWTH)
    return h


def _without_round_off(evaluator: Evaluator, point: Linearization, v: Array) -> Array:
    """Zero the tangent's round-off.

    A refinement step with H' at a point that H cannot distinguish changes round-off, but not known components.
    """
    small = (v != 0.0) & (np.abs(v) < SUSPECT * float(np.abs(v).max()))
    if not small.any():
        return v
    r = evaluator.residual(point.u)
    onward = allowed_along(evaluator.residual, point.u, v, np.abs(r) + evaluator.round_off(point.u, r))
    beside = point.u + POINT_ULPS * np.spacing(np.abs(point.u)) * generic_vector(v.size)
    if onward < ENDLESS:
        beside += onward * v
    try:
        apply = evaluator.differential(beside)
    except EvaluationError:
        # At the edge of a domain.
        apply = evaluator.differential(point.u)
    if apply is None:
        return v
    replaced = np.abs(point.solve(-apply(v))) > REPLACED * np.abs(v)
    return np.where(small & replaced, 0.0, v)


def _across(v: Array, z: Array) -> Array:
    """A correction z without its median part along v."""
    moving = v != 0.0
    across: Array = z - median(z[moving] / v[moving]) * v
    return across


def _largest(samples: list[Array]) -> Array:
    found: Array = np.abs(samples).max(axis=0)
    return found


def _nonlinearity(
    evaluator: Evaluator, point: Linearization, v: Array, h: float, residual: Array, unseen: Array
) -> tuple[Array, float]:
    """Correction at u + h v, across v, and nonlinearity."""
    moving, there = v != 0.0, point.u + h * v
    unseen = np.maximum(unseen, UNCERTAIN * np.spacing(np.abs(there)))

    def corrected(at: Array) -> Array:
        z = _across(v, point.approximate(residual - evaluator.residual(at)))
        return np.where(np.abs(z) > unseen, z, 0.0)

    d = corrected(there)
    e = corrected(there + d)
    relative = np.abs(d[moving]) / (h * np.abs(v[moving]))
    turned = median(relative)
    if moving[-1]:
        # Unknowns that move alike turn only against the parameter.
        turned = max(turned, 0.5 * float(relative[-1]))
    scale = np.maximum(h * np.abs(v), np.abs(d))
    scale[scale == 0.0] = 1.0
    first, second = (math.sqrt(dot(part, part)) for part in (d / scale, e / scale))
    return d, max(turned, min(second / first, 1.0)) if first > 0.0 else turned
