"""The length of a path, by quadrature."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arguments.checks import instance_with
from continuation.arrays import Array
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import Automatic, Euclidean, Metric, Weighted, norm
from continuation.path import Path
from continuation.path.path import require_path
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.point.segment import hermite
from continuation.step.options import PARTS
from continuation.tolerance import Tolerance

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
_CHECK_NODES = np.concatenate(([0.0], _NODES[1:4], [1.0]))
_CHECK_WEIGHTS: Array = np.linalg.solve(np.vander(_CHECK_NODES, increasing=True).T, 1.0 / np.arange(1.0, 6.0))
"""Weights of the rule of degree 5 on the inner Gauss nodes and the ends."""

_AGREEMENT = 1e-8
"""Relative difference of the two rules; Gauss's (degree 9) is far more accurate."""

_DIVISIONS = 20


def arclength(homotopy: Any, path: Path, metric: Metric | None = None) -> float:
    """The length of a traced path, by Gauss quadrature on its points.

    Planes orthogonal to a step's chord cut the path; there its speed is |v| / (border . v) for the tangent v. Five or
    more nodes a step; the error is about 1e-9.

    Parameters
    ----------
    homotopy : Homotopy
        As traced.
    path : Path
    metric : Metric, optional
        Default Euclidean in (y, lam).

    Raises
    ------
    ValueError
        If the path has no step.
    ArithmeticError
        If the path cannot be followed, as at a branch point.
    """
    require_path(path)
    check_metric(metric)
    solver = PathSolver(Evaluator(homotopy, Counts()), Tolerance())
    planes, rule = metric_of(homotopy, path), Euclidean() if metric is None else metric
    total = 0.0
    current: Array | None = None
    measure: Array | None = None
    before: Linearization | None = None
    for step in path.steps:
        current = planes.weights(step.u, step.tangent, current)
        here = linearize(solver.evaluator, step.u, current, current * step.tangent)
        if before is not None and measure is not None:
            try:
                total += _length(solver, before, here, measure, _DIVISIONS)
            except EvaluationError as error:
                where = f"path: steps {step.index - 1} and {step.index} are not joined"
                raise ArithmeticError(f"{where}: {error}") from error
        before, measure = here, rule.weights(step.u, step.tangent, measure)
    return total


def _length(solver: PathSolver, a: Linearization, b: Linearization, measure: Array, divisions: int) -> float:
    """The length from a to b in the metric `measure`."""
    chord = norm(a.weights, b.u - a.u)
    if chord <= 1e-14 * norm(a.weights, a.u):
        return norm(measure, b.u - a.u)
    border = a.weights * (b.u - a.u) / chord
    segment = hermite(a.u, a.tangent, b.u, b.tangent, border)
    nearer = (a if t < 0.5 else b for t in _NODES)
    inside = [solver.project_and_linearize(near, segment.at(t), border) for near, t in zip(nearer, _NODES)]
    points = (a, *inside, b)
    along = np.array([float(np.dot(border, point.tangent)) for point in points])
    if (along > 0.0).all():
        speeds = np.array([norm(measure, point.tangent) for point in points]) / along
        gauss = chord * float(np.dot(_WEIGHTS, speeds[1:-1]))
        check = chord * float(np.dot(_CHECK_WEIGHTS, speeds[[0, 2, 3, 4, 6]]))
        if abs(gauss - check) <= _AGREEMENT * gauss:
            return gauss
    if divisions == 0:
        raise EvaluationError(f"the path could not be measured near lam = {a.lam:g}")
    middle = inside[len(inside) // 2]
    return sum(_length(solver, p, q, measure, divisions - 1) for p, q in ((a, middle), (middle, b)))


def metric_of(homotopy: Any, path: Path) -> Metric:
    """The homotopy's own metric, else that at the path's end."""
    own: Metric | None = getattr(homotopy, "metric", None)
    if own is not None:
        return own
    weights = path.steps[-1].weights
    if weights is None:
        extent = np.ptp(path.u, axis=0)
        weights = Automatic().of_extent(np.where(extent > 0.0, extent, float(extent.max()) or 1.0))
    return Weighted(weights[:-1], float(weights[-1]))


def check_metric(metric: Any) -> None:
    """Raise TypeError unless `metric` is a metric or None."""
    if metric is not None:
        instance_with("metric", metric, *PARTS["metric"])
