"""Extent: how far each component goes before the path turns; it gives the first scales and the first step.

The result depends neither on units nor on the origin. It measures the nonlinearity of H along the tangent v as in
Deuflhard's affine covariant theory (Newton Methods for Nonlinear Problems, Sections 2.1 and 5.1). At u + h v it
computes the simplified Newton corrections d and e. The median over the components of |d_i| / (h |v_i|) measures how far
the path turned, |e| / |d| how far the equations changed. Both grow like h.
"""

from __future__ import annotations

import math

import numpy as np

from continuation.arrays import Array, dot, generic_vector, median
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import POINT_ULPS, Evaluator
from continuation.evaluation.noise import ENDLESS, allowed_along
from continuation.point.linearization import Linearization

TURN = 0.25
"""Nonlinearity at the extent. Between 0.1 and 0.5 factorisations on twelve problems differ by a tenth."""

AROUND = 1.001
"""Accuracy of the search for TURN, as a factor; a power law covers the rest, with an error of about the square. The
result must not depend on the origin: with 1.05 shifts changed the extent by 1 % and factorisations on Bratu's problem
by a factor of two.
"""

POWERS = 0.5, 4.0
"""Bounds of that power: one is usual, two for a path symmetric about its start."""

FIRST_STEP = 0.3
"""First step, in extents: it turns by a third of TURN; the controllers aim at 0.4 radians."""

SEARCH_START = 1e-3
"""First length of the search, relative to the distance to the target: short enough not to jump over the first turn."""

LENGTHS_TRIED = 40
"""Limit of lengths tried; five are usual."""

GROWTH = 30.0
"""Largest growth of the length in one try: the nonlinearity of a straight beginning predicts nothing."""

STRAIGHT_LENGTH = 1e30
"""A path without target that is straight to this length, relative to its start, has no scale."""

STANDSTILL = 1e-60
"""A component with less than this part of the largest motion, whatever the units, stands still."""

STILL_PIECEWISE = 1e-13
"""The value of STANDSTILL on a piece of a piecewise smooth map, where components stand still but for round-off of
others; units thirteen orders apart look like that too.
"""

SUSPECT, REPLACED = 1e-8, 0.1
"""Tangent components below the first value, relative to the largest, may be round-off; those that refinement changes by
more than the second are.
"""

UNCERTAIN = 100.0
"""Corrections below this multiple of their round-off, sampled with two sign patterns, are ignored."""

OTHER_UNITS = 1e4
"""A size with larger nonlinearity has other units; six symmetric trunks in units of 1 had 0.2 to 1,100."""


def initial_extent(
    evaluator: Evaluator,
    point: Linearization,
    target: float | None,
    residual: Array,
    farthest: float = np.inf,
    room: float = np.inf,
    sizes: Array | None = None,
) -> tuple[Array, Array]:
    """Return how far each component goes until the path turns by about TURN or reaches the target; and its noise.

    Parameters
    ----------
    evaluator : Evaluator
    point : Linearization
        The start, in any metric.
    target : float or None
    residual : ndarray, shape (N,)
        H at the point: a start need not lie on the path to the last digit.
    farthest : float
        Fallback length along the tangent without a target. Finite only for paths of straight pieces, which have no
        other scale.
    room : float
        Distance along the tangent to a requested end value, if the path is straight.
    sizes : ndarray, shape (N + 1,), optional
        Approximate sizes of the components; one that moves by less than its round-off stands still.

    Returns
    -------
    extent : ndarray, shape (N + 1,)
        Positive. A component without motion beyond round-off gets the median of the others, in units of `sizes` if
        given.
    blur : ndarray, shape (N + 1,)
        Uncertainty of each component: |H'^-1| times the noise in H and in the last digits of u.
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
    # The length that changes one component by its own size; if nothing is known of the path, shorter is safer.
    changed = np.abs(u[moving]) / size[moving]
    nearest = float(changed[changed > 0.0].min(initial=whole)) if np.isinf(whole) else whole
    # Terms that vanish at the origin, as for a structure at rest, show no noise there: measure it where the search
    # begins.
    ahead = SEARCH_START * length if not u[:-1].any() else 0.0
    way = (nearest if np.isfinite(nearest) else length) * v
    try:
        noise = evaluator.measure_noise(u + ahead * v, way, evaluator.residual(u + ahead * v) if ahead else residual)
    except EvaluationError:
        ahead, noise = 0.0, evaluator.measure_noise(u, way, residual)
    samples = [point.approximate(signs * noise) for signs in (np.sign(generic_vector(noise.size)), 1.0)]
    # Across the path: hold the moving component with the least relative noise.
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
            # H is probed beyond its domain: ignore exceptions; a step that needs the point will show them.
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
                # Only the start's own size is left as a scale.
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
        extent[still] *= _smaller(evaluator, point, np.where(still, extent, 0.0), residual)
    return extent, blur


def _smaller(evaluator: Evaluator, point: Linearization, z: Array, residual: Array) -> float:
    """Factor for the sizes of components that stand still, so that H is about linear at that distance from the path.

    The sizes of other components have other units. From a symmetric trunk, branches leave in these components: if their
    size is far too large, a whole branch is as short as round-off of the others.
    """
    h, moved = 1.0, z > 0.0
    for _ in range(LENGTHS_TRIED):
        try:
            d = point.solve(residual - evaluator.residual(point.u + h * z))
            turned = float((np.abs(d + h * z)[moved] / (h * z[moved])).max())
        except Exception:
            # As in `initial_extent`.
            turned = np.inf
        if turned <= OTHER_UNITS:
            break
        # The leading terms have order two or three; the square root suits three.
        h *= max(np.sqrt(TURN / turned), TURN / GROWTH)
    return h


def _without_round_off(evaluator: Evaluator, point: Linearization, v: Array) -> Array:
    """The tangent, with zeros for components that are round-off.

    A component of 1e-17 may be round-off or have another unit. One step of refinement decides, with H' at a point that
    H cannot distinguish from this one: a few ulps away, and as far along the path as H stays round-off. Refinement
    replaces round-off (also that of H', and small components next to a fold) and keeps all else.
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
        # The point lies outside the domain.
        apply = evaluator.differential(point.u)
    if apply is None:
        return v
    replaced = np.abs(point.solve(-apply(v))) > REPLACED * np.abs(v)
    return np.where(small & replaced, 0.0, v)


def _across(v: Array, z: Array) -> Array:
    """The correction minus its part along v, the median over the moving components."""
    moving = v != 0.0
    across: Array = z - median(z[moving] / v[moving]) * v
    return across


def _largest(samples: list[Array]) -> Array:
    found: Array = np.abs(samples).max(axis=0)
    return found


def _nonlinearity(
    evaluator: Evaluator, point: Linearization, v: Array, h: float, residual: Array, unseen: Array
) -> tuple[Array, float]:
    """The correction at u + h v minus its part along v, and the nonlinearity."""
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
        # Unknowns that all move alike turn only relative to the parameter.
        turned = max(turned, 0.5 * float(relative[-1]))
    scale = np.maximum(h * np.abs(v), np.abs(d))
    scale[scale == 0.0] = 1.0
    first, second = (math.sqrt(dot(part, part)) for part in (d / scale, e / scale))
    return d, max(turned, min(second / first, 1.0)) if first > 0.0 else turned
