"""Whether a path has returned to its start."""

from __future__ import annotations

import math

from continuation.arrays import SIX_DIGITS
from continuation.evaluation.errors import EvaluationError
from continuation.metric import inner, norm
from continuation.point.arc import Arc
from continuation.point.linearization import ROUND_OFF_LEFT, Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Knot

SAME_POINT = ROUND_OFF_LEFT
"""Distance, in tolerances, of equal points, found in other planes and metrics."""


def same_ray(solver: PathSolver, origin: Knot, point: Linearization) -> bool:
    """Whether a path that began in a kink leaves it again by its first branch."""
    if solver.tolerance.measure(point.u - origin.u, point.weights) > SAME_POINT:
        return False
    v = origin.tangent / norm(point.weights, origin.tangent)
    return norm(point.weights, point.tangent - v) <= math.sqrt(SIX_DIGITS)


def passes_start(solver: PathSolver, origin: Knot, arc: Arc) -> bool:
    """Whether the arc passes the start in the start's direction.

    It must cross the plane orthogonal to the start's tangent from behind, at the start once corrected. In the start's
    own metric a path would cross once more near a turning point.
    """
    weights = arc.a.weights
    v = origin.tangent / norm(weights, origin.tangent)
    behind = inner(weights, v, arc.a.u - origin.u)
    ahead = inner(weights, v, arc.b.u - origin.u)
    if not behind < 0.0 <= ahead:
        return False
    guess = arc.segment.at(behind / (behind - ahead))
    step = norm(weights, arc.b.u - arc.a.u)
    # Segments err by far less than half of their length.
    if norm(weights, guess - origin.u) > 0.5 * step:
        return False
    border = weights * v
    guess = guess - v * inner(weights, v, guess - origin.u)
    try:
        point = solver.project_and_linearize(arc.b, guess, border)
    except EvaluationError:
        return False
    same = solver.tolerance.measure(point.u - origin.u, weights) <= SAME_POINT
    return same and inner(weights, point.tangent, v) > 0.0
