"""More points of a path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve

from continuation.arguments.checks import complain, is_number
from continuation.arrays import Array
from continuation.contraction import HALVING
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import norm
from continuation.path.steps import LocatedEvent, Step
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.point.segment import Segment, hermite
from continuation.status import Kind
from continuation.tolerance import Tolerance

DEEPEST = 8
"""Most halvings of an arc: each divides a cubic's error by 16, eight give nine digits."""


def refined_path(
    homotopy: Any, path: Sequence[Step], events: Sequence[LocatedEvent], accuracy: float
) -> tuple[list[Step], list[LocatedEvent]]:
    """Steps and events of a path with more points.

    An arc's middle is corrected onto the path. If it moves farther than `accuracy` (relative to each component's
    range), it becomes a step, and both halves are examined.
    """
    if not is_number(accuracy) or not 0.0 < accuracy < math.inf:
        raise complain(ValueError, "accuracy", "a positive number", accuracy)
    if len(path) < 2:
        return list(path), list(events)
    solver = PathSolver(Evaluator(homotopy, Counts()), Tolerance())
    points = np.array([step.u for step in path])
    allowed = accuracy * np.maximum(np.ptp(points, axis=0), 1e-12 * (1.0 + np.abs(points).max(axis=0)))
    steps, first = [path[0]], {0: 0}
    for k, (before, after) in enumerate(pairwise(path), 1):
        segment = after.segment
        between = [] if segment is None else _between(solver, before, after, segment, allowed, DEEPEST)
        knots = pairwise((before, *between, after))
        steps += [evolve(q, segment=_cubic(p, q, after.weights)) for p, q in knots] if between else [after]
        first[k] = len(steps) - 1
    steps = [evolve(step, index=k) for k, step in enumerate(steps)]
    arclengths = np.array([step.arclength for step in steps])
    after = np.maximum(np.searchsorted(arclengths, [event.arclength for event in events]), 1).tolist()
    moved = [evolve(event, step=first[event.step] if event.ends_step else k) for event, k in zip(events, after)]
    return steps, moved


def error_bound(homotopy: Any, path: Sequence[Step], points: Array, indices: Sequence[int]) -> Array:
    """Distance of a path's dense output from the path, shape (k, N + 1).

    Chord steps across the null vector of H' lead onto the path. The first is Newton's, whose error is half of what H'
    changes on the way; those after the second shrink by twice the ratio of the first two (Deuflhard, Newton Methods for
    Nonlinear Problems, Section 2.1). Infinite if they do not halve. `indices`: the step at the end of each arc.
    """
    solver = PathSolver(Evaluator(homotopy, Counts()), Tolerance())
    bounds = np.full_like(points, np.inf)
    for bound, u, i in zip(bounds, points, indices):
        weights = np.ones_like(u) if path[i].weights is None else np.asarray(path[i].weights)
        across = weights * (path[i].tangent + path[i - 1].tangent)
        try:
            near = linearize(solver.evaluator, u, weights, across / norm(1.0 / weights, across))
            noise = solver.noise_by_component(near)
            first = near.approximate(solver.evaluator.residual(u))
            second = near.approximate(solver.evaluator.residual(u - first))
        except EvaluationError:
            continue
        sizes = [norm(weights, increment) for increment in (first, second, noise)]
        q = 2.0 * sizes[1] / sizes[0] if sizes[1] > sizes[2] else 0.0
        if q <= HALVING:
            bound[:] = np.abs(first) + np.abs(second) + noise + q / (1.0 - q) * sizes[1] / np.sqrt(weights)
    return bounds


def _between(solver: PathSolver, before: Step, after: Step, segment: Segment, allowed: Array, deep: int) -> list[Step]:
    guess, slope = segment.at(0.5), segment.derivative(0.5)
    weights = np.ones_like(guess) if after.weights is None else after.weights
    length = norm(weights, slope)
    if not deep or not length > 0.0:
        return []
    border = weights * slope / length
    try:
        near: Linearization = linearize(solver.evaluator, guess, weights, border)
        point = solver.project_and_linearize(near, guess, border)
    except EvaluationError:
        return []
    if (np.abs(point.u - guess) <= allowed).all():
        return []
    tangent = point.tangent if float(np.dot(weights * slope, point.tangent)) > 0.0 else -point.tangent
    ahead = [norm(weights, segment.at(b) - segment.at(a)) for a, b in ((0.0, 0.5), (0.5, 1.0))]
    arclength = before.arclength + (after.arclength - before.arclength) * ahead[0] / sum(ahead)
    middle = Step(
        0, point.u, tangent, arclength, after.step_length, solver.evaluator.residual_norm(point.u),
        before.orientation, Kind.REGULAR, weights=after.weights,
    )  # fmt: skip
    left, right = (
        _between(solver, p, q, _cubic(p, q, after.weights), allowed, deep - 1)
        for p, q in ((before, middle), (middle, after))
    )
    return [*left, middle, *right]


def _cubic(before: Step, after: Step, weights: Array | None) -> Segment:
    border = before.tangent if weights is None else weights * before.tangent
    return hermite(before.u, before.tangent, after.u, after.tangent, border)
