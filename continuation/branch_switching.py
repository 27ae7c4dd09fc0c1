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
from continuation.events.branch_point import _borders, _full, _second, _singularity
from continuation.path import LocatedEvent
from continuation.point.linearization import linearize
from continuation.status import Kind
from continuation.tolerance import Tolerance

TRANSVERSAL = 1e-10
"""The least discriminant, relative to the coefficients, of directions that are not one: second derivatives by
differences have ten digits."""


def branch_directions(homotopy: Any, event: LocatedEvent) -> tuple[Array, Array]:
    """The directions of the two branches that cross at a simple branch point.

    The roots of the algebraic bifurcation equation sum_ij alpha_i alpha_j phi' H''[w_i, w_j] = 0 on the kernel
    (Keller 1977; Allgower and Georg, Section 8.1).

    Parameters
    ----------
    homotopy : Homotopy
    event : LocatedEvent
        Of kind BRANCH_POINT.

    Returns
    -------
    (known, other) : ndarray, shape (N + 1,)
        Of unit Euclidean length; `known` is the one nearer to the event's tangent.

    Raises
    ------
    TypeError, ValueError
        If the event is none, or no branch point.
    ArithmeticError
        If the quadratic form is definite or vanishes: then no second simple branch crosses there.
    """
    if not isinstance(event, LocatedEvent):
        raise complain(TypeError, "event", "a located event of a path", event)
    if event.kind != Kind.BRANCH_POINT:
        raise ValueError(f"event: expected a branch point, found {event.name!r}")
    evaluator = Evaluator(homotopy, Counts())
    here = _singularity(_full(evaluator, event.u), *_borders(event.u.size))
    w = here.kernel
    rows = [_second(evaluator, event.u, here.phi, w[:, i]) for i in range(2)]
    a, b, c = float(rows[0] @ w[:, 0]), float(rows[0] @ w[:, 1]), float(rows[1] @ w[:, 1])
    discriminant = b * b - a * c
    if not discriminant > TRANSVERSAL * max(abs(a), abs(b), abs(c)) ** 2:
        raise ArithmeticError("no second branch crosses transversally at this point")
    root = np.sqrt(discriminant)
    # The two roots of a alpha^2 + 2 b alpha beta + c beta^2, in homogeneous coordinates, without cancellation.
    q = -(b + (root if b >= 0 else -root))
    pairs = ((q, a), (c, q))
    directions = [w[:, 0] * alpha + w[:, 1] * beta for alpha, beta in pairs]
    directions = [d / np.linalg.norm(d) for d in directions]
    directions.sort(key=lambda d: -abs(float(np.dot(d, event.tangent)) / float(np.linalg.norm(event.tangent))))
    return directions[0], directions[1]


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
        How far from the branch point the starts are.
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
        If no point of the other branch is found at that distance.
    """
    if not is_number(step) or not 0.0 < step < np.inf:
        raise complain(ValueError, "step", "a positive finite number", step)
    if isinstance(event, LocatedEvent) and event.kind == Kind.KINK:
        return _out_of_kink(event, ray)
    if ray is not None:
        raise ValueError(f"ray: expected None, since the event is no kink, found {ray!r}")
    _, other = branch_directions(homotopy, event)
    evaluator = Evaluator(homotopy, Counts())
    tolerance = Tolerance()
    weights = np.ones_like(event.u)
    starts = []
    for v in (other, -other):
        guess = event.u + step * v
        try:
            near = linearize(evaluator, guess, weights, v)
            correction = BorderedNewton(max_iterations=15).correct(evaluator, near, guess, v, tolerance)
        except EvaluationError as error:
            raise ArithmeticError(f"the other branch could not be reached: {error}") from error
        if not correction.converged:
            raise ArithmeticError(f"the other branch could not be reached: {correction.rejected(step)}")
        starts.append((correction.u, linearize(evaluator, correction.u, weights, v).tangent))
    return tuple(starts)


def _out_of_kink(kink: LocatedEvent, ray: int | None) -> tuple[tuple[Array, Array], ...]:
    rays = kink.rays if kink.rays is not None else np.empty((0, kink.u.size))
    if ray is None:
        return tuple((kink.u.copy(), v.copy()) for v in rays[2:])
    if not isinstance(ray, Integral) or not 0 <= ray < len(rays):
        raise complain(ValueError, "ray", f"the number of one of its {len(rays)} rays", ray)
    return ((kink.u.copy(), rays[ray].copy()),)
