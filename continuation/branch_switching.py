"""Branch switching: the directions of the branches that meet at a point of a path, and starts on the others."""

from __future__ import annotations

from numbers import Integral
from typing import Any

import numpy as np

from continuation.arguments.checks import complain, is_number
from continuation.arrays import Array
from continuation.correctors import BorderedNewton
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.events.multiple import Leaving, leaving, still, without_noise
from continuation.events.singularity import branch_point_near, row_sizes
from continuation.metric import Automatic, inner, norm
from continuation.path import LocatedEvent
from continuation.point.linearization import linearize
from continuation.status import Kind
from continuation.tolerance import Tolerance

SHORTER, TRIALS = 0.25, 16
"""Where an unknown stands still along the path, its size on the other branch is not known beforehand: shorter steps are
tried, down to a billionth of the one asked for."""

SAME_LINE = 1.0 - 1e-5
"""The cosine between the two rays of one smooth branch, whose directions are extrapolated from points on it."""

ROUND_OFF_SHARE = 1e-12
"""A component of a tangent that is smaller than this, beside the largest, may be round-off."""


def branch_directions(homotopy: Any, event: LocatedEvent) -> tuple[Array, ...]:
    """The directions of the branches that cross at a branch point: of a simple one as found when it was polished.

    The roots of the algebraic bifurcation equation sum_ij alpha_i alpha_j phi' H''[w_i, w_j] = 0 on the kernel
    (Keller 1977; Allgower and Georg, Section 8.1). Where H' loses two or three ranks, the zeros of what
    is left of the equations on a small sphere.

    Parameters
    ----------
    homotopy : Homotopy
        The one that was traced.
    event : LocatedEvent
        Of kind BRANCH_POINT or SINGULAR_POINT.

    Returns
    -------
    (known, other, ...) : ndarray, shape (N + 1,)
        Of unit Euclidean length; `known` is that of the path. Of a simple branch point there is one other.

    Raises
    ------
    TypeError, ValueError
        If the event is none, or no branch point.
    ArithmeticError
        If the event comes from a file, which keeps no directions, and they are not found again; if several ranks are
        lost, and the branches do not leave one by one: the sentence says the dimension of the kernel.
    """
    if isinstance(event, LocatedEvent) and event.kind == Kind.SINGULAR_POINT:
        found: list[Array] = []
        for branch in leaving_branches(homotopy, event)[1:]:
            ray = branch.ray / np.linalg.norm(branch.ray)
            if not any(abs(float(ray @ other)) > SAME_LINE for other in found):
                found.append(ray)
        return tuple(found)
    _, known, *others = crossing_rays(homotopy, event)
    return known / np.linalg.norm(known), others[0] / np.linalg.norm(others[0])


def leaving_branches(homotopy: Any, event: LocatedEvent, step: float = 1e-2) -> list[Leaving]:
    """All branches that leave a multiple branch point, the path's own first: the one back, then the one onward.

    Parameters
    ----------
    homotopy : Homotopy
    event : LocatedEvent
        Of kind SINGULAR_POINT.
    step : float, default 1e-2
        How far from it each is found, in the metric.

    Raises
    ------
    ArithmeticError
        If the kernel of H' has more than four dimensions, or there is a continuum of branches.
    """
    return leaving(Evaluator(homotopy, Counts()), event.u, event.tangent, metric_at(event), step)


def crossing_rays(homotopy: Any, event: LocatedEvent) -> Array:
    """Back, onward and both ways of the other branch: as they were found, or for an event of a file again.

    Parameters
    ----------
    homotopy : Homotopy
    event : LocatedEvent
        Of kind BRANCH_POINT.

    Raises
    ------
    TypeError, ValueError
        If the event is none, or no simple branch point.
    ArithmeticError
        If it comes from a file, which keeps no rays, and they are not found again.
    """
    if not isinstance(event, LocatedEvent):
        raise complain(TypeError, "event", "a located event of a path", event)
    if event.kind != Kind.BRANCH_POINT:
        raise ValueError(f"event: expected a branch point, found {event.name!r}")
    evaluator = Evaluator(homotopy, Counts())
    if event.rays is not None:
        return event.rays
    weights = metric_at(event)
    rows = row_sizes(evaluator, 1.0 / np.sqrt(weights), (event.u, event.u + 0.1 * event.tangent))
    found = branch_point_near(evaluator, event.u, event.tangent, weights, rows)
    if found is None:
        raise ArithmeticError("the branches that cross at this point could not be told")
    return found.rays(event.tangent, weights)


def metric_at(event: LocatedEvent) -> Array:
    """The metric at the event; for one of a file by what moves along its tangent, round-off apart."""
    if event.weights is not None:
        return event.weights
    size = np.abs(event.tangent)
    return Automatic().weights(event.u, np.where(size > ROUND_OFF_SHARE * size.max(), size, 0.0), None)


def switch_branch(
    homotopy: Any, event: LocatedEvent, step: float = 1e-2, *, ray: int | None = None
) -> tuple[tuple[Array, Array], ...]:
    """Starts on the crossing branch, one on either side of the branch point; at a kink, starts along its other rays.

    Each is a pair (u, v), a corrected point at distance about `step` and the direction away from the branch point;
    pass it to ``trace(homotopy, start=...)``. At a kink the point is the kink itself.

    Parameters
    ----------
    homotopy : Homotopy
        The one that was traced.
    event : LocatedEvent
        A branch point, simple or multiple, or a kink of its path.
    step : float, default 1e-2
        How far from the branch point the starts are, in the metric of the path: a fraction of its extent. Where the
        corrector does not reach the other branch from there they are nearer.
    ray : int, optional
        At a kink: which of its `rays` to turn to, in place of all on which the path neither came nor went on.

    Returns
    -------
    two pairs (u, v) of ndarray, shape (N + 1,)
        At a kink as many pairs as rays are asked for, at a multiple branch point two for each other branch.

    Raises
    ------
    TypeError, ValueError
        If the event is no branch point, or the step no positive number.
    ArithmeticError
        If no point of the other branch is found at that distance, or one of the branch that the path is on.
    """
    if not is_number(step) or not 0.0 < step < np.inf:
        raise complain(ValueError, "step", "a positive finite number", step)
    if isinstance(event, LocatedEvent) and event.kind == Kind.KINK:
        return _out_of_kink(event, ray)
    if ray is not None:
        raise ValueError(f"ray: expected None, since the event is no kink, found {ray!r}")
    if isinstance(event, LocatedEvent) and event.kind == Kind.SINGULAR_POINT:
        return tuple((branch.u, branch.tangent) for branch in leaving_branches(homotopy, event, step)[2:])
    _, onward, *others = crossing_rays(homotopy, event)
    evaluator, weights = Evaluator(homotopy, Counts()), metric_at(event)
    return tuple(_start(evaluator, event.u, away, onward, weights, step) for away in others)


def _start(
    evaluator: Evaluator, u: Array, away: Array, onward: Array, weights: Array, step: float
) -> tuple[Array, Array]:
    """A point of the other branch and its direction, at the distance asked for or nearer."""
    border, failed = weights * away, ""
    for h in step * SHORTER ** np.arange(TRIALS):
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


def _out_of_kink(kink: LocatedEvent, ray: int | None) -> tuple[tuple[Array, Array], ...]:
    rays = kink.rays if kink.rays is not None else np.empty((0, kink.u.size))
    if ray is None:
        return tuple((kink.u.copy(), v.copy()) for v in rays[2:])
    if not isinstance(ray, Integral) or not 0 <= ray < len(rays):
        raise complain(ValueError, "ray", f"the number of one of its {len(rays)} rays", ray)
    return ((kink.u.copy(), rays[ray].copy()),)
