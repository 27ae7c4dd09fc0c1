"""How far a path goes before it turns: the first scale of each component, and the first step.

Nothing here depends on units or on where zero is. The nonlinearity of H along the tangent v is measured, as Deuflhard's
affine covariant theory does (Newton Methods for Nonlinear Problems, Sections 2.1 and 5.1): at u + h v the simplified
Newton corrections d and e are computed; |d_i| / (h |v_i|), in the median over the components, says how far the path has
turned, and |e| / |d| how far the equations have changed. Both grow like h.
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
"""The nonlinearity at the extent. Between 0.1 and 0.5 factorisations on twelve problems differ by a tenth."""

AROUND = 1.001
"""The search ends within this factor of TURN; from there the nonlinearity grows like a power of the length. The extent
is then known to about the square of that: where the search began depends on where zero is, and where it ends must not.
With 1.05 shifts changed the extent by a hundredth, and factorisations on Bratu's problem by a factor of two."""

POWERS = 0.5, 4.0
"""Between these that power is looked for: one is usual, two where the path is symmetric about its start."""

FIRST_STEP = 0.3
"""The first step, in extents: it turns by about a third of TURN, where the controllers aim at 0.4 radians."""

SEARCH_START = 1e-3
"""Where the search begins, in ways to the target: far enough inside that the first turn is not jumped over."""

LENGTHS_TRIED = 40
"""At most so many lengths are tried; five are usual."""

GROWTH = 30.0
"""The next length is at most so many times the one before: the nonlinearity of a straight beginning says nothing."""

STRAIGHT_LENGTH = 1e30
"""A path without a target that is straight to this length, relative to its start, has no scale."""

STANDSTILL = 1e-60
"""A component that moves by no more than this part of the one that moves most, whatever their units, stands still."""

STILL_PIECEWISE = 1e-13
"""The same on a piece of a piecewise smooth map, where components do stand still but for the last digits of others;
units thirteen orders apart are no longer told from that."""

SUSPECT, REPLACED = 1e-8, 0.1
"""Components of the tangent that are smaller than the first, beside the largest, may be round-off; those that
refinement changes by more than the second are."""

UNCERTAIN = 100.0
"""Corrections up to so many times what round-off makes of them, in two samples of its signs, say nothing."""

SWEEPS = 10
"""Of Sinkhorn's iteration: units are known to a small factor then, which is all that a metric needs."""

OTHER_UNITS = 1e4
"""The nonlinearity above which a size is one of other units: on six symmetric trunks in units of 1: 0.2 to 1,100."""


def initial_extent(
    evaluator: Evaluator,
    point: Linearization,
    target: float | None,
    residual: Array,
    farthest: float = np.inf,
    room: float = np.inf,
    sizes: Array | None = None,
) -> tuple[Array, Array]:
    """How far each component goes while the path turns by about TURN, or to a nearer target; and its noise.

    Parameters
    ----------
    evaluator : Evaluator
    point : Linearization
        At the start, in whatever metric.
    target : float or None
    residual : ndarray, shape (N,)
        H at the point: a start need not lie on the path to the last digit.
    farthest : float
        How far along the tangent is far where there is no target: a path of straight pieces has no other scale. Finite
        for these alone.
    room : float
        How far along the tangent the path ends on a value that was asked for, if it is straight.
    sizes : ndarray, shape (N + 1,), optional
        How large the components are, about: what moves by less than their round-off then stands still.

    Returns
    -------
    extent : ndarray, shape (N + 1,)
        Positive. A component that does not move, or by round-off alone, is given the median of the others, in their
        sizes if these are known.
    blur : ndarray, shape (N + 1,)
        What noise in H, and in the last places of u, makes of each component: |H'^-1| times the noise.
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
    # So far that one of them changes by its own size: the nearer, the safer, where nothing is known of the path.
    changed = np.abs(u[moving]) / size[moving]
    nearest = float(changed[changed > 0.0].min(initial=whole)) if np.isinf(whole) else whole
    # Zero has no last place: terms that vanish there, as those of a structure at rest do, have no noise, and have it
    # where the search begins.
    ahead = SEARCH_START * length if not u[:-1].any() else 0.0
    way = (nearest if np.isfinite(nearest) else length) * v
    try:
        noise = evaluator.measure_noise(u + ahead * v, way, evaluator.residual(u + ahead * v) if ahead else residual)
    except EvaluationError:
        ahead, noise = 0.0, evaluator.measure_noise(u, way, residual)
    samples = [point.approximate(signs * noise) for signs in (np.sign(generic_vector(noise.size)), 1.0)]
    # Across the path: first with that component held which is known best beside its motion; one that stands still holds
    # nothing, even where no noise is seen in it.
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
            # Nobody asked for H there: what it raises beyond its domain is shown by the step that needs that point.
            d, turned = off, np.inf
        # From a fold the parameter moves by the correction alone.
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
                # Nothing but the start's own size is left to measure by.
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
    """The units of unknowns that stand still, beside each other: those in which their columns of H_y are of one size.

    Found by Sinkhorn's iteration with the rows of H_y, whose units are unknown too. Ones where H_y is no matrix.
    """
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
    """By what the size of components that stand still is multiplied, so that H is about linear that far from the path.

    Sizes of others say nothing of their units. Where the path is a symmetric trunk, branches leave in these components:
    measured by ever so much too much, what is round-off of others is a branch's whole length.
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
        # The terms that matter are of second order or of third; the root suits the latter.
        h *= max(np.sqrt(TURN / turned), TURN / GROWTH)
    return h


def _without_round_off(evaluator: Evaluator, point: Linearization, v: Array) -> Array:
    """The tangent, with zeros for components that are round-off.

    Which a component of 1e-17 is, that or one of another unit, one step of refinement tells, with H' at a point that H
    does not tell from this one: a few units in the last places away, and as far along the path as H stays round-off. It
    replaces round-off, that of H' too, and what the path has next to a fold, and leaves what is known.
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
    """A correction without its part along v, in the median over the components that move."""
    moving = v != 0.0
    across: Array = z - median(z[moving] / v[moving]) * v
    return across


def _largest(samples: list[Array]) -> Array:
    found: Array = np.abs(samples).max(axis=0)
    return found


def _nonlinearity(
    evaluator: Evaluator, point: Linearization, v: Array, h: float, residual: Array, unseen: Array
) -> tuple[Array, float]:
    """The correction at u + h v, without its part along v, and how nonlinear the path is so far."""
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
        # Unknowns that all move alike turn against the parameter alone.
        turned = max(turned, 0.5 * float(relative[-1]))
    scale = np.maximum(h * np.abs(v), np.abs(d))
    scale[scale == 0.0] = 1.0
    first, second = (math.sqrt(dot(part, part)) for part in (d / scale, e / scale))
    return d, max(turned, min(second / first, 1.0)) if first > 0.0 else turned
