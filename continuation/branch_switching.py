"""Branch switching at a simple branch point: the directions of both branches, and starts on the other one."""

from __future__ import annotations

from numbers import Integral
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.checks import complain, is_number
from continuation.correctors import BorderedNewton
from continuation.counts import Counts
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.metric import inner, norm
from continuation.path import LocatedEvent
from continuation.point.linearization import linearize
from continuation.status import Kind
from continuation.tolerance import Tolerance


def branch_directions(homotopy: Any, event: LocatedEvent) -> tuple[Array, Array]:
    """The directions of the two branches that cross at a simple branch point, as they were found when it was polished.

    The roots of the algebraic bifurcation equation sum_ij alpha_i alpha_j phi' H''[w_i, w_j] = 0 on the kernel
    (Keller 1977; Allgower and Georg, Section 8.1).

    Parameters
    ----------
    homotopy : Homotopy
        The one that was traced.
    event : LocatedEvent
        Of kind BRANCH_POINT.

    Returns
    -------
    (known, other) : ndarray, shape (N + 1,)
        Of unit Euclidean length; `known` is that of the path.

    Raises
    ------
    TypeError, ValueError
        If the event is none, no branch point, or one without directions.
    """
    if not isinstance(event, LocatedEvent):
        raise complain(TypeError, "event", "a located event of a path", event)
    if event.kind != Kind.BRANCH_POINT:
        raise ValueError(f"event: expected a branch point, found {event.name!r}")
    if event.rays is None:
        raise ValueError("event: it has no `rays`, like those of paths traced by earlier versions; trace it anew")
    known, other = event.rays[1], event.rays[2]
    return known / np.linalg.norm(known), other / np.linalg.norm(other)


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
        A branch point or a kink of its path.
    step : float, default 1e-2
        How far from the branch point the starts are, in the metric of the path: a fraction of its extent.
    ray : int, optional
        At a kink: which of its `rays` to turn to, in place of all on which the path neither came nor went on.

    Returns
    -------
    two pairs (u, v) of ndarray, shape (N + 1,)
        At a kink as many pairs as rays are asked for.

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
    branch_directions(homotopy, event)
    evaluator = Evaluator(homotopy, Counts())
    assert event.rays is not None
    _, onward, *others = event.rays
    extent = np.abs(event.rays).max(axis=0)
    # What moves on neither branch, to first order, is measured like the others.
    extent[extent == 0.0] = float(np.median(extent[extent > 0.0]))
    weights = extent**-2.0
    starts = []
    for away in others:
        guess, border = event.u + step * away, weights * away
        try:
            near = linearize(evaluator, guess, weights, border)
            correction = BorderedNewton(max_iterations=15).correct(evaluator, near, guess, border, Tolerance())
            if not correction.converged:
                raise ArithmeticError(f"the other branch could not be reached: {correction.rejected(step)}")
            v = linearize(evaluator, correction.u, weights, border).tangent
        except EvaluationError as error:
            raise ArithmeticError(f"the other branch could not be reached: {error}") from error
        way = correction.u - event.u
        new, old = (abs(inner(weights, way, d)) / norm(weights, d) for d in (away, onward))
        if new <= old:
            raise ArithmeticError("the start fell back onto the branch that the path is on: take another `step`")
        starts.append((correction.u, v))
    return tuple(starts)


def _out_of_kink(kink: LocatedEvent, ray: int | None) -> tuple[tuple[Array, Array], ...]:
    rays = kink.rays if kink.rays is not None else np.empty((0, kink.u.size))
    if ray is None:
        return tuple((kink.u.copy(), v.copy()) for v in rays[2:])
    if not isinstance(ray, Integral) or not 0 <= ray < len(rays):
        raise complain(ValueError, "ray", f"the number of one of its {len(rays)} rays", ray)
    return ((kink.u.copy(), rays[ray].copy()),)
