"""Points brought onto the path, to round-off, with whichever factorisation will do."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from continuation.arrays import Array
from continuation.evaluation.evaluator import CountedSystem, EvaluationError, Evaluator
from continuation.metric import norm
from continuation.point.arc import Arc
from continuation.point.linearization import Anchor, Linearization, relinearize
from continuation.tolerance import Tolerance

SLACK = 0.02
"""How far off the path the middle of an arc may be, in lengths of the arc."""


def project_onto_path(
    evaluator: Evaluator, near: Linearization, guess: Array, border: Array, tolerance: Tolerance
) -> tuple[Array, Anchor]:
    """Bring a guess onto the path, to round-off, and say with which factorisation.

    Chord steps with a factorisation from nearby while they halve the increment or better; else with one made at the
    guess, which is made again where it was when that does not contract either. EvaluationError if nothing helps.
    """
    settled = _polished(evaluator, guess, lambda r: near.solve(r, 0.0, border), tolerance, enough=1e-4)
    if settled is not None:
        return settled, near.anchor
    u = guess.copy()
    # Round-off may keep increments from shrinking to the end: in the last passes the tolerance itself is enough.
    for enough in (1e-4, 1e-4, 1e-4, 1.0, 1.0, 1.0):
        system = evaluator.factor(u, border)
        settled = _polished(evaluator, u, partial(_against, system), tolerance, enough)
        if settled is not None:
            return settled, Anchor(u, border, system)
        u = u + system.solve(-evaluator.residual(u), 0.0)
    raise EvaluationError("a point of the path could not be settled")


def _against(system: CountedSystem, r: Array) -> Array:
    return system.approximate(r, 0.0)


def _polished(
    evaluator: Evaluator, guess: Array, solve: Callable[[Array], Array], tolerance: Tolerance, enough: float
) -> Array | None:
    """Chord steps until increments stop halving; the point if they are then within `enough` of the tolerance."""
    u, size = guess.copy(), np.inf
    for _ in range(20):
        increment = solve(-evaluator.residual(u))
        before, size = size, tolerance.measure(increment, u)
        if size > 0.5 * before:
            return u if before <= enough else None
        u += increment
        if size <= 1e-6:
            return u
    return u if size <= enough else None


def project_and_linearize(
    evaluator: Evaluator, near: Linearization, guess: Array, border: Array, tolerance: Tolerance
) -> Linearization:
    """The path's point on the hyperplane through `guess`, linearized, oriented by angle with the border."""
    u, anchor = project_onto_path(evaluator, near, guess, border, tolerance)
    return relinearize(evaluator, u, near.weights, anchor, border)


def midpoint_on_path(evaluator: Evaluator, arc: Arc, tolerance: Tolerance) -> bool:
    """Whether the middle of the segment lies near the path: two points of different branches are joined by no arc.

    One residual and one solve with the factorisation at hand estimate how far the middle is off. On an arc that turns
    by less than a right angle a cubic misses its middle by less than a hundredth of its length.
    """
    middle, _ = arc.samples[len(arc.samples) // 2]
    off = arc.a.solve(-evaluator.residual(middle))
    if norm(arc.a.weights, off) <= SLACK * norm(arc.a.weights, arc.b.u - arc.a.u):
        return True
    # On a step as short as the noise of the residual the middle cannot do better than that noise.
    return tolerance.measure(off, middle) <= 1e2
