"""Whether a path has come back to its start: a closed curve."""

from __future__ import annotations

from continuation.evaluation.errors import EvaluationError
from continuation.metric import inner, norm
from continuation.point.arc import Arc
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Knot

SAME_POINT = 1e3
"""How far apart two points of one path may be, in tolerances, that are one: both were corrected to the tolerance, in
planes and metrics of their own, and a condition of a thousand is ordinary."""

SAME_TANGENT = 1e-3
"""How far apart the unit tangents of one branch may be, for points that are as far apart as that."""

NEAR_START = 0.5
"""How near an arc must pass to be looked at, in its lengths: half a step is far more than a segment errs."""


def same_ray(solver: PathSolver, origin: Knot, point: Linearization) -> bool:
    """Whether a path that began in a kink leaves it again by the branch on which it began."""
    if solver.tolerance.measure(point.u - origin.u, point.weights) > SAME_POINT:
        return False
    v = origin.tangent / norm(point.weights, origin.tangent)
    return norm(point.weights, point.tangent - v) <= SAME_TANGENT


def passes_start(solver: PathSolver, origin: Knot, arc: Arc) -> bool:
    """Whether the arc passes through the start in the start's direction.

    The plane through the start and orthogonal to its tangent must be crossed from behind, near the start; the crossing
    is then corrected in that plane and must be the start itself. Both in the metric of the arc: that of the start knows
    only how far the path went there, and near a turning point its plane is crossed once more.
    """
    weights = arc.a.weights
    v = origin.tangent / norm(weights, origin.tangent)
    behind = inner(weights, v, arc.a.u - origin.u)
    ahead = inner(weights, v, arc.b.u - origin.u)
    if not behind < 0.0 <= ahead:
        return False
    guess = arc.segment.at(behind / (behind - ahead))
    step = norm(weights, arc.b.u - arc.a.u)
    if norm(weights, guess - origin.u) > NEAR_START * step:
        return False
    border = weights * v
    guess = guess - v * inner(weights, v, guess - origin.u)
    try:
        point = solver.project_and_linearize(arc.b, guess, border)
    except EvaluationError:
        return False
    same = solver.tolerance.measure(point.u - origin.u, weights) <= SAME_POINT
    return same and inner(weights, point.tangent, v) > 0.0
