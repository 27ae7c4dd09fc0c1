"""A traced path examined afterwards: its length by quadrature, and whether a retrace finds the same path."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve, field, frozen

from continuation.arrays import Array
from continuation.budget import Budget
from continuation.checks import check_flag, complain, instance_with, is_number
from continuation.controllers import Bounds, Decision, StepMeasures
from continuation.counts import Counts
from continuation.ends.closed_curve import SAME_POINT, passes_start
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.metric import Automatic, Euclidean, Metric, Weighted, inner, norm
from continuation.path import LocatedEvent, Path, Step, require_path
from continuation.point.arc import Arc
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.point.segment import hermite
from continuation.predictors import Knot
from continuation.presets import CONSERVATIVE
from continuation.status import Status
from continuation.step.options import PARTS
from continuation.step.tracer import Tracer
from continuation.tolerance import Tolerance, as_tolerance

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
_MIDDLE = 2
_CHECK_NODES = np.concatenate(([0.0], _NODES[1:4], [1.0]))
_CHECK_WEIGHTS: Array = np.linalg.solve(np.vander(_CHECK_NODES, increasing=True).T, 1.0 / np.arange(1.0, 6.0))
"""The interpolatory rule, of degree 5, on the inner Gauss nodes and the ends, where the speed is known anyway."""

_AGREEMENT = 1e-8
"""Relative difference of the two rules; Gauss's, of degree 9, is then far more accurate."""

_DIVISIONS = 20


def arclength(homotopy: Any, path: Path, metric: Metric | None = None) -> float:
    """The length of a traced path, by Gauss's quadrature on points of the path itself.

    Each step is cut by planes orthogonal to its chord (in the homotopy's metric); where the path meets a plane its
    speed is |v| / (border . v), v the tangent there. Five nodes a step, more where they do not suffice, so that the
    error is one of quadrature (about 1e-9) and not of an interpolant.

    Parameters
    ----------
    homotopy : Homotopy
        The one that was traced.
    path : Path
        Of at least one step.
    metric : Metric, optional
        Euclidean in (y, lam) unless given; need not be that of the trace.

    Raises
    ------
    ValueError
        If the path has no step.
    ArithmeticError
        If the path cannot be followed between two of its points, as in a branch point.
    """
    require_path(path)
    _check_metric(metric)
    solver = PathSolver(Evaluator(homotopy, Counts()), Tolerance())
    planes, rule = _metric_of(homotopy, path), Euclidean() if metric is None else metric
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
    """The length from a to b in the metric of `measure`; the planes are orthogonal in the metric of a."""
    chord = norm(a.weights, b.u - a.u)
    if chord <= 1e-14 * norm(a.weights, a.u):
        return norm(measure, b.u - a.u)
    border = a.weights * (b.u - a.u) / chord
    segment = hermite(a.u, a.tangent, b.u, b.tangent, border)
    nearer = (a if t < 0.5 else b for t in _NODES)
    inside = [
        solver.project_and_linearize(near, segment.at(t), border) for near, t in zip(nearer, _NODES)
    ]
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
    middle = inside[_MIDDLE]
    return sum(_length(solver, p, q, measure, divisions - 1) for p, q in ((a, middle), (middle, b)))


def _check_metric(metric: Any) -> None:
    if metric is not None:
        instance_with("metric", metric, *PARTS["metric"])


def _metric_of(homotopy: Any, path: Path) -> Metric:
    """The homotopy's own metric, else the one in which the path ended."""
    own: Metric | None = getattr(homotopy, "metric", None)
    if own is not None:
        return own
    weights = path.steps[-1].weights
    if weights is None:
        extent = np.ptp(path.u, axis=0)
        weights = Automatic().of_extent(np.where(extent > 0.0, extent, float(extent.max()) or 1.0))
    return Weighted(weights[:-1], float(weights[-1]))


@frozen(eq=False)
class Audit:
    """What a retrace says of a path.

    Attributes
    ----------
    same : bool
        Whether the retrace passes through every point of the path, in order and direction, with as many turning points.
    sentence : str
        The finding in words.
    first : int or None
        Index of the first step that the retrace does not pass through; None if it passes through all.
    retraced : Path
        The retrace, for a closer look.
    """

    same: bool
    sentence: str
    first: int | None
    retraced: Path

    def __str__(self) -> str:
        return self.sentence


@frozen(eq=False)
class Halved:
    """A controller that takes, at each arclength, at most half the step that another trace took there.

    State: the arclength accumulated so far.
    """

    knots: Array
    max_angle: float = 0.3
    bounds: Bounds = field(init=False)

    @bounds.default
    def _half_the_first(self) -> Bounds:
        first = 0.5 * float(self.knots[1] - self.knots[0])
        return Bounds(minimum=1e-6 * min(first, float(np.diff(self.knots).min())), initial=first)

    def init(self) -> tuple[float, ...]:
        """At the start."""
        return (0.0,)

    def update(self, state: tuple[float, ...], attempt: StepMeasures) -> Decision:
        """Half the other trace's step after success, half the attempt's after failure."""
        # A correction as long as the step leads to another part of the path, or to another path, even if parallel.
        if not attempt.converged or attempt.angle > self.max_angle or attempt.distance > 0.3 * attempt.h:
            return Decision(False, 0.5 * attempt.h, state)
        s = state[0] + attempt.h
        k = min(max(int(np.searchsorted(self.knots, s, side="right")), 1), self.knots.size - 1)
        limit = 0.5 * float(self.knots[k] - self.knots[k - 1])
        return Decision(True, min(limit, 2.0 * attempt.h), (s,))


def audit(
    homotopy: Any,
    path: Path,
    *,
    metric: Metric | None = None,
    tolerance: float | Tolerance = 1e-8,
    backwards: bool = False,
) -> Audit:
    """Whether the tracer stayed on one path: a retrace with half the steps must pass through the same points.

    A tracer that jumped to another path, or over a loop of its own, did so with a long step; the retrace then misses
    the first point behind the jump. It costs about twice the trace and four times its factorisations.

    Parameters
    ----------
    homotopy : Homotopy
        The one that was traced.
    path : Path
        Of at least one step.
    metric : Metric, optional
        As given to the trace.
    tolerance : float or Tolerance
        As given to the trace; points may differ by a thousand times as much.
    backwards : bool
        Retrace from the end to the start: a jump is rarely made in both directions.

    Returns
    -------
    Audit

    Raises
    ------
    ValueError
        If the path has no step.
    """
    require_path(path)
    _check_metric(metric)
    check_flag("backwards", backwards)
    rule, tolerance = metric or _metric_of(homotopy, path), as_tolerance(tolerance)
    indices = [k for k, step in enumerate(path.steps) if k == 0 or (step.u != path.steps[k - 1].u).any()]
    sign = 1.0
    if backwards:
        indices, sign = indices[::-1], -1.0
    knots = _knots([path.steps[k] for k in indices], path.kinks, sign, rule)
    tracer = Tracer(
        homotopy,
        preset=CONSERVATIVE,
        controller=Halved(np.array([knot.arclength for knot in knots])),
        metric=rule,
        tolerance=tolerance,
        target=path.endpoint.lam if path.status is Status.REACHED_TARGET and not backwards else None,
        start=(knots[0].u, knots[0].tangent),
        budget=Budget(steps=20 * len(knots) + 100),
    )
    met = _follow(tracer, knots, tolerance)
    if met < len(knots):
        return Audit(False, _missed(path, indices[met], tracer.path), indices[met], tracer.path)
    turns, expected = _turns(tracer, knots[-1], tolerance), len(path.turning_points)
    same = turns == expected
    sentence = f"The retrace passes through all points, with {turns} turning points"
    return Audit(same, sentence + ("." if same else f" instead of {expected}."), None, tracer.path)


def _knots(steps: list[Step], kinks: list[LocatedEvent], sign: float, metric: Metric) -> list[Knot]:
    """The points to be met, with accumulated chords for arclengths."""
    onward = {event.step: event.rays[1] for event in kinks if event.rays is not None and len(event.rays) > 1}

    def tangent(step: Step) -> Array:
        # A path has two tangents in a kink: a retrace meets it with the one that it comes with.
        return -onward[step.index] if sign < 0.0 and step.index in onward else sign * step.tangent

    knots = [Knot(0.0, steps[0].u, tangent(steps[0]))]
    weights: Array | None = None
    for before, after in pairwise(steps):
        weights = metric.weights(before.u, before.tangent, weights)
        knots.append(Knot(knots[-1].arclength + norm(weights, after.u - before.u), after.u, tangent(after)))
    return knots


def _follow(tracer: Tracer, knots: list[Knot], tolerance: Tolerance) -> int:
    """How many of the knots the trace meets, in order, before it ends or has clearly missed one."""
    solver = PathSolver(Evaluator(tracer.homotopy, Counts()), tolerance)
    met, met_at = 1, 0.0
    before: Linearization | None = None
    for step in tracer:
        assert tracer.state is not None
        weights = tracer.state.weights
        here = linearize(solver.evaluator, step.u, weights, weights * step.tangent)
        while before is not None and met < len(knots) and _meets(solver, knots[met], before, here):
            met, met_at = met + 1, step.arclength
        # Between two points of one path lies little more than their chord; a loop that was left out is longer.
        if met == len(knots) or step.arclength - met_at > 2.0 * (knots[met].arclength - knots[met - 1].arclength):
            break
        before = here
    return met


def _meets(solver: PathSolver, knot: Knot, before: Linearization, after: Linearization) -> bool:
    if inner(after.weights, after.tangent, knot.tangent) > 0.0 and _same(after, knot.u, solver.tolerance):
        return True
    arc = Arc(before, after, before.border, hermite(before.u, before.tangent, after.u, after.tangent, before.border))
    unit = evolve(knot, tangent=knot.tangent / norm(after.weights, knot.tangent))
    return passes_start(solver, unit, after.weights, arc)


def _same(point: Linearization, wanted: Array, tolerance: Tolerance) -> bool:
    return tolerance.measure(point.u - wanted, point.weights) <= SAME_POINT


def _turns(tracer: Tracer, end: Knot, tolerance: Tolerance) -> int:
    """Turning points up to the end; the last step may lie beyond it."""
    assert tracer.state is not None
    last, weights = len(tracer.path) - 1, tracer.state.weights
    return sum(
        event.step < last
        or inner(weights, end.tangent, event.u - end.u) <= 0.0
        or tolerance.measure(event.u - end.u, weights) <= SAME_POINT
        for event in tracer.path.turning_points
    )


def _missed(path: Path, k: int, retraced: Path) -> str:
    step = path.steps[k]
    where = f"step {k} (arclength {step.arclength:.6g}, lam = {step.lam:.6g})"
    ended = retraced.status not in (Status.TRACING, Status.ABANDONED)
    return f"The retrace does not pass through {where}." + (f" It ended: {retraced.message}" if ended else "")


def refine(homotopy: Any, path: Path, s: float, tolerance: float | Tolerance = 1e-8) -> Array:
    """The path at arclength s, corrected onto it: dense output to round-off, whatever the segments are worth.

    Parameters
    ----------
    homotopy : Homotopy
        The one that was traced.
    path : Path
    s : float
        Between 0 and the last arclength.
    tolerance : float or Tolerance, default 1e-8
        Of the corrector.

    Returns
    -------
    ndarray, shape (N + 1,)

    Raises
    ------
    ArithmeticError
        If the corrector fails there.
    """
    require_path(path)
    if not is_number(s) or not math.isfinite(s):
        raise complain(TypeError if not is_number(s) else ValueError, "s", "a finite number", s)
    solver = PathSolver(Evaluator(homotopy, Counts()), as_tolerance(tolerance))
    u = path(float(s))
    ahead = path(min(float(s) + 1e-6 * path.arclength[-1], path.arclength[-1]))
    behind = path(max(float(s) - 1e-6 * path.arclength[-1], 0.0))
    border = (ahead - behind) / np.linalg.norm(ahead - behind)
    near = linearize(solver.evaluator, u, np.ones_like(u), border)
    settled, _ = solver.project(near, u, border)
    return settled
