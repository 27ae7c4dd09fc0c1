"""Whether a path has come back to its start: a closed curve."""

from __future__ import annotations

from continuation.arrays import Array
from continuation.evaluation.evaluator import EvaluationError
from continuation.metric import inner, norm
from continuation.point.arc import Arc
from continuation.point.projection import PathSolver
from continuation.predictors import Knot

SAME_POINT = 1e3
"""How far apart two points of one path may be, in tolerances, that are one: both were corrected to the tolerance, in
planes and metrics of their own, and a condition of a thousand is ordinary."""

NEAR = 0.5
"""How near an arc must pass to be looked at, in its lengths: half a step is far more than a segment errs."""


def passes_start(solver: PathSolver, origin: Knot, weights: Array, arc: Arc) -> bool:
    """Whether the arc passes through the start in the start's direction.

    The plane through the start and orthogonal to its tangent must be crossed from behind, near the start; the crossing
    is then corrected in that plane and must be the start itself.
    """
    behind = inner(weights, origin.tangent, arc.a.u - origin.u)
    ahead = inner(weights, origin.tangent, arc.b.u - origin.u)
    if not behind < 0.0 <= ahead:
        return False
    guess = arc.segment.at(behind / (behind - ahead))
    step = norm(weights, arc.b.u - arc.a.u)
    if norm(weights, guess - origin.u) > NEAR * step:
        return False
    border = weights * origin.tangent
    guess = guess - origin.tangent * inner(weights, origin.tangent, guess - origin.u)
    try:
        point = solver.project_and_linearize(arc.b, guess, border)
    except EvaluationError:
        return False
    same = solver.tolerance.measure(point.u - origin.u, arc.a.weights) <= SAME_POINT
    return same and inner(weights, point.tangent, origin.tangent) > 0.0
