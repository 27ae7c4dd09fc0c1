"""What a trace recognises besides its target: a closed curve, a path that runs off, a branch point passed."""

from __future__ import annotations

from continuation.arrays import Array, largest
from continuation.evaluation import EvaluationError, Evaluator
from continuation.location import Arc, land
from continuation.metric import inner, norm
from continuation.predictors import Knot
from continuation.tolerance import Tolerance

DECADES = 3
"""Decades of growth without progress of the parameter after which a path counts as divergent."""

SLACK = 0.02
"""How far off the path the middle of an arc may be, in lengths of the arc."""

HORIZON = 1e12
"""Growth of y, relative to its start, at which a path counts as divergent."""


def closes(evaluator: Evaluator, origin: Knot, weights: Array, arc: Arc, tolerance: Tolerance) -> bool:
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
        point = land(evaluator, arc.b, guess, border, tolerance)
    except EvaluationError:
        return False
    same = tolerance.measure(point.u - origin.u, origin.u) <= 1e3
    return same and inner(weights, point.tangent, origin.tangent) > 0.0


def connected(evaluator: Evaluator, arc: Arc, tolerance: Tolerance) -> bool:
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


def divergence(
    marks: tuple[float, float, float], u: Array, start_norm: float
) -> tuple[tuple[float, float, float], bool]:
    """Follow the growth of y by decades: (norm at the last mark, parameter there, decades stalled), and the verdict.

    A path diverges when y has grown by three decades in a row, beyond a thousand times its start, while the parameter
    moved by less than a thousandth in each, or when it is beyond the horizon, whatever the parameter does.
    """
    mark, lam, stalled = marks
    size = largest(u[:-1])
    if mark == 0.0:
        return (max(size, 1.0), float(u[-1]), 0.0), False
    if size < 10.0 * mark:
        return marks, False
    still = abs(float(u[-1]) - lam) <= 1e-3 * max(1.0, abs(float(u[-1])))
    stalled = stalled + 1.0 if still else 0.0
    far = size > 1e3 * (1.0 + start_norm)
    return (size, float(u[-1]), stalled), (stalled >= DECADES and far) or size > HORIZON * (1.0 + start_norm)
