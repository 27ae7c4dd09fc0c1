"""Errors of an answer against the truth; all are relative, and NaN where nothing is known."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.auditing.length import arclength as quadrature
from continuation.chart.model import Answer, Problem
from continuation.correctors import MoorePenrose
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import Euclidean
from continuation.path import Path
from continuation.point.linearization import linearize
from continuation.tolerance import Tolerance

BETWEEN = (0.25, 0.5, 0.75)
"""Where in each step the dense output is compared with the curve."""

_TIGHT = Tolerance(relative=1e-12)
"""Of the correction that drops a point onto the curve: the next Newton step would be below round-off."""


@frozen
class Error:
    """A measure of the error.

    Attributes
    ----------
    name : str
        A column's.
    label : str
        An axis's.
    measure : callable
        (problem, answer) to a number >= 0, or NaN where it does not apply.
    """

    name: str
    label: str
    measure: Callable[[Problem, Answer], float]


def distance(found: Array, true: Array) -> float:
    """The largest difference of components, relative to 1 plus the largest true one."""
    return float(np.abs(found - true).max() / (1.0 + np.abs(true).max()))


def _end_point(problem: Problem, answer: Answer) -> float:
    true = problem.truth.end
    return math.nan if true is None or answer.end is None else distance(answer.end, true)


def _turning_points(problem: Problem, answer: Answer) -> float:
    true = problem.truth.turning_points
    if true is None or answer.path is None or not len(true) or len(answer.path.turning_points) != len(true):
        return math.nan
    return max(distance(event.u, row) for event, row in zip(answer.path.turning_points, true))


def _arclength(problem: Problem, answer: Answer) -> float:
    true = problem.truth.arclength
    if true is None or answer.path is None or len(answer.path) < 2:
        return math.nan
    try:
        return abs(quadrature(problem.subject, answer.path, Euclidean()) - true) / true
    except ArithmeticError:
        return math.nan


def _curve_distance(problem: Problem, answer: Answer) -> float:
    """The largest distance of the path, its dense output between the points included, from the exact curve."""
    path = answer.path
    if path is None or len(path) < 2:
        return math.nan
    points = _sampled(path)
    nearest = problem.truth.nearest
    true = nearest(points) if nearest is not None else _dropped(problem, points)
    gaps = np.abs(points - true).max(axis=1) / (1.0 + np.abs(true).max(axis=1))
    return float(gaps.max())


def _sampled(path: Path) -> Array:
    # At values of the segments' own parameter: any points of the dense output will do.
    inner = [
        after.segment.at(t) if after.segment is not None else (1.0 - t) * before.u + t * after.u
        for before, after in pairwise(path.steps)
        for t in BETWEEN
    ]
    return np.concatenate([path.u, inner])


def _dropped(problem: Problem, points: Array) -> Array:
    """Each point moved onto the curve along the normal, by Newton's method to round-off; NaN where that fails."""
    evaluator = Evaluator(problem.subject, Counts())
    weights = np.ones(points.shape[1])
    found = []
    for u in points:
        try:
            here = linearize(evaluator, u, weights, np.ones_like(u))
            correction = MoorePenrose(max_contraction=10.0).correct(evaluator, here, u, here.border, _TIGHT)
        except ArithmeticError:
            found.append(np.full_like(u, np.nan))
            continue
        found.append(correction.u if correction.converged else np.full_like(u, np.nan))
    return np.array(found)


def observed(name: str, label: str) -> Error:
    """A scalar that the homotopy (its `observe`) or the method reports at the end and that is zero at a solution.

    Parameters
    ----------
    name : str
        The key in `Answer.observed`.
    label : str
        Of an axis.

    Returns
    -------
    Error
        NaN where nothing of that name is reported.
    """
    return Error(name, label, lambda problem, answer: float(answer.observed.get(name, math.nan)))


END_POINT = Error("end_point", "relative error of the end point", _end_point)
TURNING_POINTS = Error("turning_points", "relative error of the turning points", _turning_points)
ARCLENGTH = Error("arclength", "relative error of the arclength", _arclength)
CURVE_DISTANCE = Error("curve_distance", "relative distance of the dense output from the curve", _curve_distance)
NATURAL_RESIDUAL = observed("natural_residual", "natural residual max |min(x, Ax + q)|")
