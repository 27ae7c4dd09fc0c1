"""Retraces, and points between those of a path."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve, field, frozen

from continuation.arguments.checks import check_flag, expect, instance_with, is_number
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.controllers import Bounds, Decision, StepMeasures
from continuation.counts import Counts
from continuation.ends.closed_curve import SAME_POINT, passes_start
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import Automatic, Metric, Weighted, inner, norm
from continuation.path import LocatedEvent, Path, Step
from continuation.path.path import require_path
from continuation.point.arc import cubic_between
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.predictors import Knot
from continuation.status import Status
from continuation.step.options import PARTS
from continuation.step.presets import CONSERVATIVE
from continuation.step.tracer import Tracer
from continuation.tolerance import Tolerance, as_tolerance

BEFORE = 0.1
"""Share of the last step before a branch point at which a retrace begins: nearer, H' is almost singular."""


@frozen(eq=False)
class Audit:
    """Result of a retrace.

    `same`: whether it passes every point in order and direction, with as many turning points and branch points.
    `first`: first missed step, or None.
    """

    same: bool
    sentence: str
    first: int | None
    retraced: Path

    def __str__(self) -> str:
        return self.sentence


@frozen(eq=False)
class Halved:
    """A controller with steps at most half as long as another trace's; its state is the arclength."""

    knots: Array
    max_angle: float = 0.3
    bounds: Bounds = field(init=False)

    @bounds.default
    def _half_the_first(self) -> Bounds:
        first = 0.5 * float(self.knots[1] - self.knots[0])
        return Bounds(minimum=1e-6 * min(first, float(np.diff(self.knots).min())), initial=first)

    def init(self) -> tuple[float, ...]:
        """The initial state."""
        return (0.0,)

    def update(self, state: tuple[float, ...], attempt: StepMeasures) -> Decision:
        """Half the other trace's step after success, else half the attempt's."""
        # A correction as long as the step leads to another path.
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
    """Check that the tracer stayed on one path: a retrace with steps half as long must pass the same points.

    It misses the next point after a jump, or over a loop. It takes about twice the trace's time.

    Parameters
    ----------
    homotopy : Homotopy
        As traced.
    path : Path
    metric : Metric, optional
        As in the trace.
    tolerance : float or Tolerance
        As in the trace; points may differ by a thousand times as much.
    backwards : bool
        Retrace from end to start: jumps rarely occur both ways.

    Raises
    ------
    ValueError
        If the path has no step.
    """
    require_path(path)
    if metric is not None:
        instance_with("metric", metric, *PARTS["metric"])
    check_flag("backwards", backwards)
    rule, tolerance = metric or metric_of(homotopy, path), as_tolerance(tolerance)
    indices = [k for k, step in enumerate(path.steps) if k == 0 or (step.u != path.steps[k - 1].u).any()]
    sign = 1.0
    if backwards:
        indices, sign = indices[::-1], -1.0
    steps, crossings = [path.steps[k] for k in indices], path.branch_points
    if backwards and crossings and crossings[-1].ends_step and crossings[-1].step == steps[0].index:
        # Paths do not begin regularly at branch points.
        s = steps[0].arclength + BEFORE * (steps[1].arclength - steps[0].arclength)
        crossings = crossings[:-1]
        steps[0] = evolve(steps[0], u=refine(homotopy, path, s, tolerance), tangent=steps[1].tangent)
    knots = _knots(steps, path.kinks, sign, rule)
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
    words, same = [], True
    for name, found, stored in (
        ("turning points", tracer.path.turning_points, path.turning_points),
        ("branch points", tracer.path.branch_points, crossings),
    ):
        passed, expected = _passed(tracer, found, knots[-1], tolerance), len(stored)
        same = same and passed == expected
        words.append(f"{passed} {name}" + ("" if passed == expected else f" instead of {expected}"))
    sentence = f"The retrace passes through all points, with {' and '.join(words)}."
    return Audit(same, sentence, None, tracer.path)


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


def _knots(steps: list[Step], kinks: list[LocatedEvent], sign: float, metric: Metric) -> list[Knot]:
    onward = {event.step: event.rays[1] for event in kinks if event.rays is not None and len(event.rays) > 1}

    def tangent(step: Step) -> Array:
        # A kink has two tangents: use the incoming one.
        return -onward[step.index] if sign < 0.0 and step.index in onward else sign * step.tangent

    knots = [Knot(0.0, steps[0].u, tangent(steps[0]))]
    weights: Array | None = None
    for before, after in pairwise(steps):
        weights = metric.weights(before.u, before.tangent, weights)
        knots.append(Knot(knots[-1].arclength + norm(weights, after.u - before.u), after.u, tangent(after)))
    return knots


def _follow(tracer: Tracer, knots: list[Knot], tolerance: Tolerance) -> int:
    """Number of knots met in order before the trace ends or misses one."""
    solver = PathSolver(Evaluator(tracer.homotopy, Counts()), tolerance)
    met, met_at = 1, 0.0
    before: Linearization | None = None
    for step in tracer:
        assert tracer.state is not None
        weights = tracer.state.weights
        here = linearize(solver.evaluator, step.u, weights, weights * step.tangent)
        located = [event for event in tracer.path.branch_points if event.step == step.index]
        while (
            before is not None
            and met < len(knots)
            and (
                _meets(solver, knots[met], before, here)
                or any(_same(weights, event, knots[met], solver.tolerance) for event in located)
            )
        ):
            met, met_at = met + 1, step.arclength
        # A missed loop is longer than the chord.
        if met == len(knots) or step.arclength - met_at > 2.0 * (knots[met].arclength - knots[met - 1].arclength):
            break
        before = here
    return met


def _meets(solver: PathSolver, knot: Knot, before: Linearization, after: Linearization) -> bool:
    if _same(after.weights, after, knot, solver.tolerance):
        return True
    arc = cubic_between(before, after, before.border)
    return passes_start(solver, knot, arc)


def _same(weights: Array, point: Linearization | LocatedEvent, knot: Knot, tolerance: Tolerance) -> bool:
    onward = inner(weights, point.tangent, knot.tangent) > 0.0
    return onward and tolerance.measure(point.u - knot.u, weights) <= SAME_POINT


def _passed(tracer: Tracer, events: list[LocatedEvent], end: Knot, tolerance: Tolerance) -> int:
    assert tracer.state is not None
    last, weights = len(tracer.path) - 1, tracer.state.weights
    return sum(
        event.step < last
        or inner(weights, end.tangent, event.u - end.u) <= 0.0
        or tolerance.measure(event.u - end.u, weights) <= SAME_POINT
        for event in events
    )


def _missed(path: Path, k: int, retraced: Path) -> str:
    step = path.steps[k]
    where = f"step {k} (arclength {step.arclength:.6g}, lam = {step.lam:.6g})"
    ended = retraced.status not in (Status.TRACING, Status.ABANDONED)
    return f"The retrace does not pass through {where}." + (f" It ended: {retraced.message}" if ended else "")


def refine(homotopy: Any, path: Path, s: float, tolerance: float | Tolerance = 1e-8) -> Array:
    """The path's point at arclength s, corrected to round-off.

    Parameters
    ----------
    homotopy : Homotopy
        As traced.
    path : Path
    s : float
        Between 0 and the last arclength.
    tolerance : float or Tolerance, default 1e-8
        The corrector's.

    Returns
    -------
    ndarray, shape (N + 1,)

    Raises
    ------
    ArithmeticError
        If the corrector fails.
    """
    require_path(path)
    expect(is_number(s) and math.isfinite(s), "s", "a finite number", s, TypeError if not is_number(s) else ValueError)
    solver = PathSolver(Evaluator(homotopy, Counts()), as_tolerance(tolerance))
    u = path(float(s))
    ahead = path(min(float(s) + 1e-6 * path.arclength[-1], path.arclength[-1]))
    behind = path(max(float(s) - 1e-6 * path.arclength[-1], 0.0))
    border = (ahead - behind) / np.linalg.norm(ahead - behind)
    near = linearize(solver.evaluator, u, np.ones_like(u), border)
    settled, _ = solver.project(near, u, border)
    return settled
