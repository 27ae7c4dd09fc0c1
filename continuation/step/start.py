"""The first point: corrected, checked, oriented."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from continuation.arguments.checks import real_vector
from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, generic_vector, median
from continuation.correctors import BorderedNewton
from continuation.correctors.base import holds
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.homotopy import SupportsExtents, offers
from continuation.metric import Automatic, Metric, SupportsExtent, norm
from continuation.path import Path
from continuation.point.linearization import NEAR_SINGULAR, Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.step.extent import FIRST_STEP, REPLACED, initial_extent


class StartError(ArithmeticError):
    """The start lies on no path."""


class SingularStartError(StartError):
    """The Jacobian has no full rank at the start: the path has no direction."""


CORRECTING = BorderedNewton(max_iterations=20)
"""Many iterations are cheap: one correction a path."""

CLEAR_OF_NOISE = 4.0
"""Tolerance in units of a correction's noise: two standard deviations of a difference. With half, CONSERVATIVE fails in
single precision."""

COARSEST = 0.1
"""Tolerance if noise leaves no digit; later checks reject wrong starts."""

PATIENT = BorderedNewton(reuse=0.0, max_iterations=20, max_contraction=math.inf)
"""From a guess increments may first grow."""


def first_point(
    solver: PathSolver, u: Array, metric: Metric, direction: int, target: float | None
) -> tuple[Linearization, float]:
    """Return the corrected start with tangent, and a first step length.

    `direction`: sign of the tangent's parameter component; 0: towards the target, else +1. Raises `StartError` if no
    path is near, SingularStartError if H' loses rank.
    """
    evaluator, tolerance = solver.evaluator, solver.tolerance
    unit = np.append(np.zeros(u.size - 1), 1.0)
    try:
        residual = evaluator.residual(u)
    except EvaluationError as error:
        raise StartError(f"At the start {error}.") from error
    point, extent = measured(solver, _regular(evaluator, u, unit), metric, target, residual)
    judge, off = point, point.solve(residual)
    if tolerance.measure(off, judge.weights) > 1.0:
        u = _correct_start(solver, point, u, unit)
        residual = evaluator.residual(u)
        point, extent = measured(solver, _regular(evaluator, u, unit), metric, target, residual)
        off = judge.solve(residual)
    # Unknowns no larger than the start's error are zeros with a solver's round-off: they give no scale.
    while (left := _left_of_zero(point.u, off)).any():
        u = np.where(left, 0.0, point.u)
        try:
            residual = evaluator.residual(u)
            off = judge.solve(residual)
            if tolerance.measure(off, judge.weights) > 1.0:
                break
            point, extent = measured(solver, _regular(evaluator, u, unit), metric, target, residual)
        except (EvaluationError, SingularStartError):
            break  # H has no value, or no derivative, at zero.
    wanted = direction
    if wanted == 0:
        wanted = 1 if target is None or target >= u[-1] else -1
    if point.tangent[-1] * wanted < 0:
        point = evolve(point, tangent=-point.tangent, orientation=-point.orientation)
    return point, FIRST_STEP * norm(point.weights, extent)


def at_parameter(solver: PathSolver, u: Array) -> Array:
    """The path's point at a guess's parameter value; `StartError` if Newton's method fails."""
    evaluator = solver.evaluator
    unit = np.append(np.zeros(u.size - 1), 1.0)
    try:
        residual = evaluator.residual(u)
        point, _ = measured(solver, _regular(evaluator, u, unit), Automatic(), None, residual)
        for corrector in (CORRECTING, PATIENT):
            correction = corrector.correct(evaluator, point, u, unit, solver.tolerance)
            if correction.converged and holds(evaluator, correction.u):
                return correction.u
    except EvaluationError as error:
        raise StartError(f"At the guess {error}.") from error
    said = str(correction.rejected(0.0) or f"at its end H is {correction.residual_norm:.3g}, which is no round-off")
    raise StartError(f"Newton's method at lam = {u[-1]:g} says: {said.rstrip('.')}.")


def measured(
    solver: PathSolver, point: Linearization, metric: Metric, target: float | None, residual: Array
) -> tuple[Linearization, Array]:
    """Start in the trace's metric, and its extent.

    Noise of H raises the tolerance, and the extents of noisier components.
    """
    room = np.inf if solver.room is None else solver.room(point.u, point.tangent)
    homotopy = solver.evaluator.homotopy
    sizes = homotopy.extents if offers(homotopy, SupportsExtents) else None
    extent, blur = initial_extent(solver.evaluator, point, target, residual, room, sizes)
    noisy = solver.evaluator.noise is not None
    least = max(CLEAR_OF_NOISE * median(blur / extent), solver.tolerance.relative)
    solver.noisy(min(least, COARSEST) if noisy else 0.0)
    extent = np.maximum(extent, CLEAR_OF_NOISE * blur / solver.tolerance.relative)
    if isinstance(metric, SupportsExtent):
        return point.with_weights(metric.of_extent(extent)), extent
    return point.with_weights(metric.weights(point.u, point.tangent, None)), extent


def _correct_start(solver: PathSolver, point: Linearization, u: Array, unit: Array) -> Array:
    for border in (unit, point.border):
        correction = CORRECTING.correct(solver.evaluator, point, u, border, solver.tolerance)
        # A start off its parameter is corrected by its extent at most.
        if correction.converged and (border is unit or correction.distance <= 1.0):
            return correction.u
    patient = PATIENT.correct(solver.evaluator, point, u, unit, solver.tolerance)
    if patient.converged:
        return patient.u
    raise StartError(f"The corrector says: {correction.rejected(0.0)}.")


def _left_of_zero(u: Array, off: Array) -> NDArray[np.bool_]:
    """Nonzero components of which the Newton step -off changes more than the part `REPLACED`."""
    return np.asarray((u != 0.0) & (np.abs(off) > REPLACED * np.abs(u)))


def _regular(evaluator: Evaluator, u: Array, unit: Array) -> Linearization:
    """Linearize at u; SingularStartError unless [H_y, H_lam] has full rank.

    Border e_{N+1} fails at turning points; a kernel that depends on random borders has several dimensions.
    """
    ones = np.ones_like(u)
    try:
        point = linearize(evaluator, u, ones, unit)
        if _well_conditioned(point):
            return point
        # Units may make the parameter component small. A border without units confirms it by the same kernel.
        v = point.tangent
        border = np.divide(1.0, v, out=np.zeros_like(v), where=v != 0.0)
        again = linearize(evaluator, u, ones, border / norm(ones, border))
        if (np.abs(again.tangent - v) <= SIX_DIGITS * np.abs(v)).all():
            return again
    except EvaluationError:
        pass
    generator = np.random.default_rng(0)
    found = []
    for _ in range(2):
        border = generator.standard_normal(u.size)
        try:
            found.append(linearize(evaluator, u, ones, border / norm(ones, border)))
        except EvaluationError as error:
            raise SingularStartError(f"({error}.)") from error
    alignment = abs(float(np.dot(found[0].tangent, found[1].tangent)))
    if alignment < 1.0 - SIX_DIGITS:
        raise SingularStartError("The kernel of [H_y, H_lam] has more than one dimension there.")
    return found[0]


def _well_conditioned(point: Linearization) -> bool:
    r = generic_vector(point.u.size - 1)
    z = point.solve(r)
    image = norm(np.ones_like(r), r)
    return norm(np.ones_like(z), z) < NEAR_SINGULAR * image and abs(point.tangent[-1]) > ROOT_OF_ROUND_OFF


def is_guess(start: Any) -> bool:
    """Whether a start is (y, lam)."""
    return isinstance(start, tuple | list) and len(start) == 2 and np.ndim(start[1]) == 0 and np.ndim(start[0]) == 1


def guessed(start: Any) -> Array:
    """A start (y, lam) as one vector; ValueError otherwise."""
    y, lam = (real_vector("start", part) for part in start)
    u: Array = np.append(y, lam)
    if not np.isfinite(u).all():
        raise ValueError("start: expected finite numbers, found NaN or infinity")
    return u


def arriving(path: Path) -> tuple[Array, Array]:
    """The last point of a path, with its tangent or the last chord; `ValueError` if it has neither."""
    before, last = [None, *path.steps[-2:]][-2:] if len(path.steps) else (None, None)
    if last is None:
        raise ValueError("start: expected a path with a point to go on from, found one without")
    known = bool(np.isfinite(last.tangent).all())
    if not known and before is None:
        raise ValueError("start: expected a path with a tangent, or two points, found one point without a tangent")
    return last.u, last.tangent if known or before is None else last.u - before.u


def point_and_direction(start: Any) -> tuple[Array, Array]:
    """Copies of a start's finite point and direction; ValueError otherwise."""
    if not isinstance(start, tuple | list) or len(start) != 2:
        found = f"{len(start)} of them" if isinstance(start, tuple | list) else repr(start)
        raise ValueError(f"start: expected a pair (u, v) of vectors, found {found}; a guess is (y, lam)")
    u, v = (real_vector("start", part) for part in start)
    if u.ndim != 1 or u.shape != v.shape:
        raise ValueError(f"start: expected (u, v), vectors of one size, found shapes {u.shape} and {v.shape}")
    if not (np.isfinite(u).all() and np.isfinite(v).all() and v.any()):
        raise ValueError("start: expected a finite point and a direction that does not vanish")
    return u, v


def point_from_tangent(
    solver: PathSolver, start: tuple[Array, Array], metric: Metric, target: float | None
) -> tuple[Linearization, float]:
    """Begin at a point in a direction, which orients the determinant."""
    evaluator, (u, v) = solver.evaluator, start
    weights = metric.weights(u, v, None)
    try:
        point = linearize(evaluator, u, weights, weights * (v / norm(weights, v)))
        point, extent = measured(solver, point, metric, target, evaluator.residual(u))
    except EvaluationError as error:
        raise SingularStartError(f"({error}.)") from error
    return point, FIRST_STEP * norm(point.weights, extent)
