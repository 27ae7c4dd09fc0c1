"""Whether a path has come back to its start: a closed curve."""

from __future__ import annotations

from continuation.arrays import Array
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.metric import inner, norm
from continuation.point.arc import Arc
from continuation.point.projection import project_and_linearize
from continuation.predictors import Knot
from continuation.tolerance import Tolerance


def passes_start(evaluator: Evaluator, origin: Knot, weights: Array, arc: Arc, tolerance: Tolerance) -> bool:
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
    if norm(weights, guess - origin.u) > 0.5 * step:
        return False
    border = weights * origin.tangent
    guess = guess - origin.tangent * inner(weights, origin.tangent, guess - origin.u)
    try:
        point = project_and_linearize(evaluator, arc.b, guess, border, tolerance)
    except EvaluationError:
        return False
    same = tolerance.measure(point.u - origin.u, origin.u) <= 1e3
    return same and inner(weights, point.tangent, origin.tangent) > 0.0
