"""Directions of crossing branches, and starts on them."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arguments.checks import expect, is_number
from continuation.arrays import Array
from continuation.contraction import HALVING
from continuation.correctors import BorderedNewton
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.events.multiple import NOISE, Leaving, leaving, still, without_noise
from continuation.events.singularity import branch_point_near, scales
from continuation.metric import Automatic, inner, norm
from continuation.path import LocatedEvent
from continuation.point.linearization import linearize
from continuation.status import Kind
from continuation.tolerance import Tolerance

TRIALS = 32
"""Trial steps, each half of the last: on the other branch the size of an unknown that stands still here is not known.
"""

ONE_LINE = -0.99
"""Largest cosine between the two rays of one branch: a point where four cross is known to 1e-4, its rays to 1e-2."""


def branch_directions(homotopy: Any, event: LocatedEvent) -> tuple[Array, ...]:
    """Return the branches' directions at a branch point.

    At a simple one they solve sum_ij alpha_i alpha_j phi' H''[w_i, w_j] = 0 on the kernel (Keller 1977; Allgower and
    Georg, Section 8.1).

    Parameters
    ----------
    homotopy : Homotopy
    event : LocatedEvent
        Kind BRANCH_POINT or SINGULAR_POINT.

    Returns
    -------
    (known, other, ...) : ndarray, shape (N + 1,)
        Euclidean unit vectors; `known` is the path's.

    Raises
    ------
    TypeError, ValueError
        If the event is no branch point.
    ArithmeticError
        If directions, not stored in files, are not found, or branches are not isolated.
    """
    if isinstance(event, LocatedEvent) and event.kind == Kind.SINGULAR_POINT:
        back, *rays = leaving_branches(homotopy, event)
        found: list[Array] = []
        while rays:
            # The rays of one branch err by as much as the point, in opposite directions.
            one = rays.pop(0)
            other = min(rays if found else [back], key=lambda ray: inner(one.weights, one.ray, ray.ray), default=one)
            paired = inner(one.weights, one.ray, other.ray) < ONE_LINE
            found.append(one.ray - other.ray if paired else one.ray)
            rays = [ray for ray in rays if not (paired and ray is other)]
        return tuple(ray / np.linalg.norm(ray) for ray in found)
    _, known, *others = crossing_rays(homotopy, event)
    return known / np.linalg.norm(known), others[0] / np.linalg.norm(others[0])


def leaving_branches(homotopy: Any, event: LocatedEvent, step: float = 1e-2) -> list[Leaving]:
    """All branches at a multiple branch point, first the path's, back and onward.

    `step`: distance of the points. Raises `ArithmeticError` if the kernel of H' has more than four dimensions, or
    branches form a continuum.
    """
    return leaving(Evaluator(homotopy, Counts()), event.u, event.tangent, metric_at(event), step)


def crossing_rays(homotopy: Any, event: LocatedEvent) -> Array:
    """The rays back, onward and both of the other branch, stored or recomputed.

    Raises `TypeError` or `ValueError` if the event is no simple branch point, `ArithmeticError` without rays.
    """
    expect(isinstance(event, LocatedEvent), "event", "a located event of a path", event, TypeError)
    if event.kind != Kind.BRANCH_POINT:
        raise ValueError(f"event: expected a branch point, found {event.name!r}")
    evaluator = Evaluator(homotopy, Counts())
    if event.rays is not None:
        return event.rays
    weights = metric_at(event)
    units = scales(evaluator, 1.0 / np.sqrt(weights), (event.u, event.u + 0.1 * event.tangent))
    found = branch_point_near(evaluator, event.u, event.tangent, weights, units)
    if found is None:
        raise ArithmeticError("the branches that cross at this point could not be told")
    return found.rays(event.tangent, weights)


def metric_at(event: LocatedEvent) -> Array:
    """The event's metric, stored or from its tangent."""
    if event.weights is not None:
        return event.weights
    size = np.abs(event.tangent)
    return Automatic().weights(event.u, np.where(size > NOISE * size.max(), size, 0.0), None)


def switch_branch(homotopy: Any, event: LocatedEvent, step: float = 1e-2) -> tuple[tuple[Array, Array], ...]:
    """Return starts on the other branches of a branch point or kink, for ``trace(homotopy, start=...)``.

    Parameters
    ----------
    homotopy : Homotopy
    event : LocatedEvent
        A branch point or kink.
    step : float, default 1e-2
        Distance of the starts in the path's metric; shorter if the corrector fails.

    Returns
    -------
    two pairs (u, v) of ndarray, shape (N + 1,)
        Point (the kink itself at a kink) and direction away: one pair for each ray, two for each other branch.

    Raises
    ------
    TypeError, ValueError
        If the event is no branch point, or the step not positive.
    ArithmeticError
        If no point of the other branch is found.
    """
    expect(is_number(step) and 0.0 < step < np.inf, "step", "a positive finite number", step)
    if isinstance(event, LocatedEvent) and event.kind == Kind.KINK:
        rays = () if event.rays is None else event.rays[2:]
        return tuple((event.u.copy(), v.copy()) for v in rays)
    if isinstance(event, LocatedEvent) and event.kind == Kind.SINGULAR_POINT:
        return tuple((branch.u, branch.tangent) for branch in leaving_branches(homotopy, event, step)[2:])
    _, onward, *others = crossing_rays(homotopy, event)
    evaluator, weights = Evaluator(homotopy, Counts()), metric_at(event)
    return tuple(_start(evaluator, event.u, away, onward, weights, step) for away in others)


def _start(
    evaluator: Evaluator, u: Array, away: Array, onward: Array, weights: Array, step: float
) -> tuple[Array, Array]:
    border, failed = weights * away, ""
    for h in step * HALVING ** np.arange(TRIALS):
        guess = u + h * away
        try:
            near = linearize(evaluator, guess, weights, border)
            correction = BorderedNewton(max_iterations=15).correct(evaluator, near, guess, border, Tolerance())
            if not correction.converged:
                failed = str(correction.rejected(h))
                continue
            v = linearize(evaluator, correction.u, weights, border).tangent
        except EvaluationError as error:
            failed = str(error)
            continue
        way = correction.u - u
        new, old = (abs(inner(weights, way, d)) / norm(weights, d) for d in (away, onward))
        if new > old:
            return without_noise(u, way, weights), still(v, weights)
        failed = "the corrector fell back onto the branch that the path is on"
    raise ArithmeticError(f"the other branch could not be reached: {failed}")
