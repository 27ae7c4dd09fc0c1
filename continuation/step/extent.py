"""Extent: how far each component goes before the path turns; it gives scales and the first step.

Simplified Newton corrections d at u + h v and e at u + h v + d, v the tangent, measure nonlinearity in any units and
origin (Deuflhard, Newton Methods for Nonlinear Problems, Sections 2.1 and 5.1). The median of |d_i| / (h |v_i|) is the
path's turn, |e| / |d| the equations' change.
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
"""Nonlinearity at the extent; 0.1 to 0.5 change factorisations on twelve problems by a tenth."""

AROUND = 1.001
"""Accuracy factor of the search for TURN. With 1.05 shifted origins changed factorisations on Bratu's problem
twofold."""

POWERS = 0.5, 4.0
"""Bounds of the nonlinearity's power of length: one, two on symmetric paths."""

FIRST_STEP = 0.3
"""First step, in extents, turns by a third of TURN; controllers aim at 0.4 radians."""

SEARCH_START = 1e-3
"""First length tried, relative to the target's distance."""

LENGTHS_TRIED = 40
"""Limit of lengths; five are usual."""

GROWTH = 30.0
"""Largest growth of the length in one try: a straight beginning predicts nothing."""

STRAIGHT_LENGTH = 1e30
"""A path straight to this length, in units of its start, has no scale."""

STANDSTILL = 1e-60
"""A component that moves less, relative to the fastest, stands still."""

STILL_PIECEWISE = 1e-13
"""STANDSTILL for piecewise homotopies, whose tangents carry round-off of other components."""

SUSPECT, REPLACED = 1e-8, 0.1
"""A smaller tangent component, relatively, is round-off if refinement changes it by more than the second."""

UNCERTAIN = 100.0
"""Corrections below this multiple of their round-off are ignored."""

OTHER_UNITS = 1e4
"""A larger nonlinearity shows wrong units; six symmetric branches had 0.2 to 1,100."""


def initial_extent(
    evaluator: Evaluator,
    point: Linearization,
    target: float | None,
    residual: Array,
    room: float = np.inf,
    sizes: Array | None = None,
) -> tuple[Array, Array]:
    """Return how far each component goes until the path turns or reaches the target, and its noise, shape (N + 1,).

    Components that stand still get the median. `residual`: H at the point. `room`: distance to a terminal value.
    `sizes`: of the components.
    """
    u, v = point.u, point.tangent
    whole, gap = np.inf, np.inf if target is None or target == point.lam else target - point.lam
    if np.isfinite(gap):
        whole = abs(gap / v[-1])
        v = v * np.sign(gap / v[-1])
    exactly = sizes is None
    standstill, unit = STANDSTILL if exactly else STILL_PIECEWISE, np.ones_like(v) if sizes is None else sizes
    if not exactly:
        v = np.where(np.abs(v) > standstill * unit * float(np.abs(v / unit).max()), v, 0.0)
    given = v
    v = _without_round_off(evaluator, point, v, residual)
    size = np.abs(v)
    moving = size > 0.0
    length = min(whole, max(1.0, float((np.abs(u[moving]) / size[moving]).max())))
    # The shortest length that changes a component by its size is safest.
    changed = np.abs(u[moving]) / size[moving]
    nearest = float(changed[changed > 0.0].min(initial=whole)) if np.isinf(whole) else whole
    # At zero the terms of H have no round-off: measure it ahead.
    ahead = SEARCH_START * length if not u[:-1].any() else 0.0
    way = (nearest if np.isfinite(nearest) else length) * v
    try:
        noise = evaluator.measure_noise(u + ahead * v, way, evaluator.residual(u + ahead * v) if ahead else residual)
    except EvaluationError:
        ahead, noise = 0.0, evaluator.measure_noise(u, way, residual)
    samples = [point.approximate(signs * noise) for signs in (np.sign(generic_vector(noise.size)), 1.0)]
    blur = np.max([np.spacing(np.abs(u)), *(np.abs(_held(v, given, z)) for z in samples)], axis=0)
    if ahead and np.isfinite(whole):
        # Round-off of the tangent moves the point ahead.
        blur = np.maximum(blur, ahead * np.abs(given - v))
    v = np.where((ahead or length) * size > UNCERTAIN * blur, v, 0.0)
    size, moving = np.abs(v), v != 0.0
    seen = blur
    if np.count_nonzero(moving) > 1:
        # The median component has no noise by construction: take the next larger ratio of noise to motion.
        seen = np.maximum(blur, size * np.partition(blur[moving] / size[moving], 1)[1])
    unseen = UNCERTAIN * seen
    h = SEARCH_START * length
    low, high, power, straight = 0.0, np.inf, 1.0, True
    apart = np.abs(point.approximate(residual))
    found, off, before = h, np.zeros_like(u), (0.0, 0.0)
    for _ in range(LENGTHS_TRIED):
        try:
            d, turned = _nonlinearity(
                evaluator, point, v, given, h, residual, unseen * max(1.0, h / (ahead or h)), apart
            )
        except Exception:
            # H is probed beyond its domain.
            d, turned = off, np.inf
        # At a fold only the correction moves the parameter.
        turned = max(turned, TURN * abs((h * v[-1] + d[-1]) / gap))
        if before[1] > 0.0 and 0.0 < turned < np.inf and h != before[0]:
            power = min(max(float(np.log(turned / before[1]) / np.log(h / before[0])), POWERS[0]), POWERS[1])
        before = h, turned if turned < np.inf else 0.0
        straight &= before[1] == 0.0
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
                straight = True
                break
        h *= min(max(rest, 0.1), GROWTH)
        if not low < h < high:
            h = 0.5 * (low + high)
        h = min(h, whole)
        if high < AROUND * low:
            break
    if straight and SEARCH_START * found > length:
        # No length bends the path before H overflows, far away: only the start's size is left as a scale.
        found, off = length, (length / found) ** 2 * off
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
    """Factor for the sizes `z` of components that stand still, with which H is about linear: larger ones shorten a
    branch.
    """
    h, moved = 1.0, z > 0.0
    for _ in range(LENGTHS_TRIED):
        try:
            d = point.solve(residual - evaluator.residual(point.u + h * z))
            turned = float((np.abs(d + h * z)[moved] / (h * z[moved])).max())
        except Exception:
            turned = np.inf
        if turned <= OTHER_UNITS:
            break
        # Leading terms have order two or three.
        h *= max(np.sqrt(TURN / turned), TURN / GROWTH)
    return h


def _without_round_off(evaluator: Evaluator, point: Linearization, v: Array, residual: Array) -> Array:
    """Tangent, with zeros for round-off.

    A tiny component may have another unit: refinement by H' nearby tells.
    """
    small = (v != 0.0) & (np.abs(v) < SUSPECT * float(np.abs(v).max()))
    if not small.any():
        return v
    onward = allowed_along(evaluator.residual, point.u, v, np.abs(residual) + evaluator.round_off(point.u, residual))
    beside = point.u + POINT_ULPS * np.spacing(np.abs(point.u)) * generic_vector(v.size)
    if onward < ENDLESS:
        beside += onward * v
    try:
        apply = evaluator.differential(beside)
    except EvaluationError:
        apply = evaluator.differential(point.u)
    if apply is None:
        return v
    replaced = np.abs(point.solve(-apply(v))) > REPLACED * np.abs(v)
    return np.where(small & replaced, 0.0, v)


def _across(v: Array, given: Array, z: Array) -> Array:
    """The correction z without its part along the path: `given` times the median of z_i / v_i where v_i moves."""
    moving = v != 0.0
    across: Array = z - median(z[moving] / v[moving]) * given
    return across


def _held(v: Array, given: Array, z: Array) -> Array:
    """The noise z without its part along the path: of two middle ratios z_i / v_i, the smaller.

    Their mean would give one component the noise of the other.
    """
    moving = v != 0.0
    parts = np.sort(z[moving] / v[moving])
    beside: Array = z - min(parts[(parts.size - 1) // 2], parts[parts.size // 2], key=abs) * given
    return beside


def _nonlinearity(
    evaluator: Evaluator,
    point: Linearization,
    v: Array,
    given: Array,
    h: float,
    residual: Array,
    unseen: Array,
    apart: Array,
) -> tuple[Array, float]:
    """The correction across v at u + h v, and the nonlinearity.

    `apart`: distance of u from the path. Corrections below `unseen` are round-off.
    """
    moving, there = v != 0.0, point.u + h * v
    unseen = np.maximum(unseen, UNCERTAIN * np.spacing(np.abs(there)))

    def corrected(at: Array) -> Array:
        z = _across(v, given, point.approximate(residual - evaluator.residual(at)))
        return np.where(np.abs(z) > unseen, z, 0.0)

    d = corrected(there)
    e = corrected(there + d)
    relative = np.abs(d[moving]) / (h * np.abs(v[moving]))
    turned = median(relative)
    if moving[-1]:
        # If all unknowns turn alike, only the parameter's ratio differs from the median.
        turned = max(turned, 0.5 * float(relative[-1]))
    scale = np.maximum(h * np.abs(v), np.abs(d))
    scale[scale == 0.0] = 1.0
    first, second = (math.sqrt(dot(part, part)) for part in (d / scale, e / scale))
    turned = max(turned, min(second / first, 1.0)) if first > 0.0 else turned
    bent = ~moving & (np.abs(d) > apart)
    if bent.any():
        # A component that begins to move here, as the parameter at a fold, follows a parabola, which has no scale.
        half = corrected(point.u + 0.5 * h * v)
        bent &= half != 0.0
        if bent.any():
            turned = max(turned, median(np.abs(d - 4.0 * half)[bent] / np.abs(d[bent])))
    return d, turned
