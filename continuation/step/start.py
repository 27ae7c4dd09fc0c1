"""The first point: brought onto the path, found regular, and given its direction."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.checks import real_vector
from continuation.correctors import BorderedNewton
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.metric import Metric, norm
from continuation.point.linearization import Linearization, linearize
from continuation.status import Status
from continuation.tolerance import Tolerance


class StartError(ArithmeticError):
    """The trace cannot begin; carries the status that says why."""

    def __init__(self, status: Status, particulars: str) -> None:
        super().__init__(f"{status} {particulars}")
        self.status = status


def first_point(
    evaluator: Evaluator, u: Array, metric: Metric, tolerance: Tolerance, direction: int, target: float | None
) -> Linearization:
    """The start on the path, with the tangent that leads to the target.

    Parameters
    ----------
    direction : int
        Sign wanted of the tangent's parameter component; 0 lets the target decide (and +1 where there is none).

    Raises
    ------
    StartError
        START_NOT_ON_PATH or SINGULAR_START: the one is a wrong point, the other a wrong problem.
    """
    unit = np.zeros_like(u)
    unit[-1] = 1.0
    try:
        residual = evaluator.residual(u)
    except EvaluationError as error:
        raise StartError(Status.START_NOT_ON_PATH, f"At the start {error}.") from error
    point = _regular(evaluator, u, unit)
    if tolerance.measure(point.solve(-residual), u) > 1.0:
        u = _correct_start(evaluator, point, u, unit, tolerance)
        point = _regular(evaluator, u, unit)
    point = point.with_weights(metric.weights(u, point.tangent, None))
    wanted = direction
    if wanted == 0:
        wanted = 1 if target is None or target >= u[-1] else -1
    return _turned(point) if point.tangent[-1] * wanted < 0 else point


def _turned(point: Linearization) -> Linearization:
    return Linearization(point.u, point.weights, point.anchor, -point.tangent, -point.orientation)


def _correct_start(evaluator: Evaluator, point: Linearization, u: Array, unit: Array, tolerance: Tolerance) -> Array:
    """Correct the start, at its parameter value if that works, else along the shortest way."""
    reasons = []
    for border in (unit, point.border):
        correction = BorderedNewton(max_iterations=20).correct(evaluator, point, u, border, tolerance)
        if correction.converged:
            return correction.u
        reasons.append(correction.reason)
    raise StartError(Status.START_NOT_ON_PATH, f"The corrector says: {reasons[-1]}.")


def _regular(evaluator: Evaluator, u: Array, unit: Array) -> Linearization:
    """Linearize at u; SINGULAR_START unless [H_y, H_lam] has full rank to working precision.

    With the border e_{N+1} the matrix is singular at a turning point too, so a bad answer there is asked again with a
    border in general position. A kernel that then depends on the border has more than one dimension.
    """
    ones = np.ones_like(u)
    try:
        point = linearize(evaluator, u, ones, unit, 0)
        if _well_conditioned(point):
            return point
    except EvaluationError:
        pass
    generator = np.random.default_rng(0)
    found = []
    for _ in range(2):
        border = generator.standard_normal(u.size)
        try:
            found.append(linearize(evaluator, u, ones, border / norm(ones, border), 0))
        except EvaluationError as error:
            raise StartError(Status.SINGULAR_START, f"({error}.)") from error
    alignment = abs(float(np.dot(found[0].tangent, found[1].tangent)))
    if alignment < 1.0 - 1e-6:
        raise StartError(Status.SINGULAR_START, "The kernel of [H_y, H_lam] has more than one dimension there.")
    return found[0]


def _well_conditioned(point: Linearization) -> bool:
    """Whether a solve with a random right-hand side stays moderate: a near-singular matrix gives itself away."""
    generator = np.random.default_rng(1)
    r = generator.standard_normal(point.u.size - 1)
    z = point.solve(r)
    image = norm(np.ones_like(r), r)
    return norm(np.ones_like(z), z) < 1e10 * image and abs(point.tangent[-1]) > 1e-8


def point_and_direction(start: Any) -> tuple[Array, Array]:
    """Copies of the two vectors of a start; ValueError if it is no pair of a finite point and a direction."""
    if not isinstance(start, tuple | list) or len(start) != 2:
        found = f"{len(start)} of them" if isinstance(start, tuple | list) else repr(start)
        raise ValueError(f"start: expected a pair (u, v) of vectors, found {found}")
    u, v = (real_vector("start", part) for part in start)
    if u.ndim != 1 or u.shape != v.shape:
        raise ValueError(f"start: expected (u, v), vectors of one size, found shapes {u.shape} and {v.shape}")
    if not (np.isfinite(u).all() and np.isfinite(v).all() and v.any()):
        raise ValueError("start: expected a finite point and a direction that does not vanish")
    return u, v


def point_from_tangent(evaluator: Evaluator, start: tuple[Array, Array], size: int, metric: Metric) -> Linearization:
    """Begin at a given point in a given direction; the determinant sign there becomes the orientation.

    Raises
    ------
    ValueError
        If `start` is no pair (u, v) of vectors of the right size, or v vanishes.
    StartError
        SINGULAR_START.
    """
    u, v = point_and_direction(start)
    if u.size != size:
        raise ValueError(f"start: expected (u, v) of shape ({size},) each, found {u.shape} and {v.shape}")
    weights = metric.weights(u, v, None)
    try:
        return linearize(evaluator, u, weights, weights * (v / norm(weights, v)), 0)
    except EvaluationError as error:
        raise StartError(Status.SINGULAR_START, f"({error}.)") from error
