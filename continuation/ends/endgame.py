"""The limit of a path at a singular target: y ~ y* + c1 t + c2 t^2 + ..., t = |lam - target|^(1/w).

A power-series endgame (Morgan, Sommese and Wampler, Numerische Mathematik 63, 1992): parameter values approach the
target geometrically, and Hermite polynomials in t for each winding number w are evaluated at t = 0.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import frozen

from continuation.arrays import Array, generic_vector, largest
from continuation.contraction import MONOTONE
from continuation.correctors import BorderedNewton
from continuation.ends.landing import regular
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import norm
from continuation.point.arc import cubic_between
from continuation.point.linearization import SOLVED, Linearization, generic, linearize, relinearize
from continuation.point.projection import PathSolver, arc_on_path
from continuation.tolerance import Tolerance

RATIO = 0.2
"""Ratio of distances to the target: few points, within Newton's reach."""

RESIDUAL_RATIO = 1e-3
"""Largest residual at the limit, relative to the first sample moved to the target."""

ULPS = 8.0, -1021.0
"""Perturbations, in ulps, that show round-off; two, since lam / 1.001 is rounded alike at values 8 ulps apart."""

WINDING_NUMBERS = (1, 2, 3, 4, 5, 6)

SAMPLES_WITHOUT_GAIN = 3
"""The sampling stops after so many samples without gain."""

ROUND_OFF_SPREAD = 10.0
"""Allowed growth of round-off in H from the last sample to the limit."""

SAMPLE_TOLERANCE = 1e-3
"""Accuracy of samples, in tolerances: the extrapolation multiplies their errors."""

AMPLIFICATION = 0.3, 10.0
"""The extrapolation multiplies errors by 3, 30, 300, ... for winding numbers 1, 2, 3, ...: rounded sums of Hermite
weights at t = 0."""

EQUALLY_GOOD = 10.0
"""The smallest winding number within this factor of the best error wins: its multiples fit."""

AT_PARAMETER = BorderedNewton(max_iterations=12, max_contraction=MONOTONE)
"""Newton's method is linear near a singular end."""


@frozen(eq=False)
class SingularLimit:
    """A limit u, shape (N + 1,), exactly at the target.

    `error`: largest error of a component; `length`: that in the metric. `winding_number`: 1 if analytic, 2 for a square
    root.
    """

    u: Array
    error: float
    winding_number: int
    length: float


@frozen(eq=False)
class Sample:
    """A point, its slope dy/dlam, and its noise."""

    u: Array
    slope: Array
    noise: Array


@frozen(eq=False)
class Endgame:
    """The search for a limit at a target, with at most `samples` points."""

    solver: PathSolver
    target: float
    samples: int = 14

    def limit(self, point: Linearization) -> SingularLimit | None:
        """The limit, or None if no winding number fits to the tolerance."""
        gap = point.lam - self.target
        taken = [_sample(point, np.zeros_like(point.u))]
        best: SingularLimit | None = None
        worse = 0
        here = point
        for k in range(1, self.samples + 1):
            lam = self.target + gap * RATIO**k
            known = best is not None and self._within(best)
            tracked = self._track(here, _guess(taken, self.target, lam, best), lam, not known)
            if tracked is None:
                break
            if not self._one_branch(here, tracked[0]):
                return None
            here, noise = tracked
            taken.append(_sample(here, noise))
            if len(taken) < 3:
                continue
            end = _limit(taken, self.target, point.weights)
            if best is None or end.length < best.length:
                best, worse = end, 0
            else:
                worse += 1
            if best.length <= SOLVED or worse >= SAMPLES_WITHOUT_GAIN:
                break
        if best is None or not self._within(best):
            return None
        return best if self._holds(best, taken) and self._keeps_orientation(best, here) else None

    def _one_branch(self, before: Linearization, after: Linearization) -> bool:
        """Whether two samples lie on one branch, as far as known.

        A path keeps its orientation, which differs on the other of two branches that nearly meet (Allgower and Georg,
        Section 8.1). If it is unknown, the arc between is compared with the path, which detects five of six such ends.
        """
        if before.orientation and after.orientation:
            return before.orientation == after.orientation
        arc = cubic_between(before, after, before.border)
        return arc_on_path(self.solver, arc, arc.length) is not None

    def _keeps_orientation(self, end: SingularLimit, last: Linearization) -> bool:
        if end.winding_number > 1 or last.orientation == 0:
            return True
        try:
            guess = generic(last.weights)
            at = relinearize(self.solver.evaluator, end.u, last.weights, last.anchor, last.border, guess=guess)
        except EvaluationError:
            return True
        return at.orientation == last.orientation or not regular(self.solver, at, last)

    def _within(self, end: SingularLimit) -> bool:
        return end.length <= self.solver.tolerance.relative

    def _holds(self, end: SingularLimit, taken: list[Sample]) -> bool:
        """Whether H is round-off at the limit, or far smaller than at the first sample moved there."""
        residual_norm = self.solver.evaluator.residual_norm
        residual, round_off = residual_norm(end.u), residual_norm(taken[-1].u)
        moved = residual_norm(np.append(taken[0].u[:-1], self.target))
        return residual <= RESIDUAL_RATIO * moved + ROUND_OFF_SPREAD * round_off

    def _track(self, here: Linearization, guess: Array, lam: float, noisy: bool) -> tuple[Linearization, Array] | None:
        """Point at a parameter value, and its noise.

        If `noisy`, an increment below the tolerance is accepted as noise.
        """
        evaluator, tolerance, max_step = self.solver.evaluator, self.solver.tolerance, self.solver.max_step
        unit = np.append(np.zeros(guess.size - 1), 1.0)
        fine = Tolerance(relative=SAMPLE_TOLERANCE * tolerance.relative)
        correction = AT_PARAMETER.correct(evaluator, here, guess, unit, fine)
        u, anchor, noise = correction.u, correction.anchor, np.zeros_like(guess)
        try:
            if not correction.converged:
                if not noisy or anchor is None:
                    return None
                increment = anchor.system.solve(-evaluator.residual(u), 0.0)
                if tolerance.measure(increment, here.weights) > 1.0:
                    return None
                u, noise = u + increment, np.abs(increment)
            if max_step is not None and not max_step(here.u, u - here.u) > 1.0:
                return None
            u = np.append(u[:-1], lam)
            if anchor is not None:
                at = relinearize(evaluator, u, here.weights, anchor, here.border, guess=generic(here.weights))
            else:
                at = linearize(evaluator, u, here.weights, here.border)
            return at, np.maximum(noise, _round_off(evaluator, at, unit))
        except EvaluationError:
            return None


def _sample(point: Linearization, noise: Array) -> Sample:
    return Sample(point.u, point.tangent / point.tangent[-1], noise)


def _polynomial(taken: list[Sample], target: float, w: int) -> Callable[[float], Array]:
    """The Hermite interpolant in t, by Newton's form; t = 1 at the first sample."""
    gap = taken[0].u[-1] - target
    t = np.array([((sample.u[-1] - target) / gap) ** (1.0 / w) for sample in taken])
    nodes, table = np.repeat(t, 2), np.repeat([sample.u for sample in taken], 2, axis=0)
    coefficients = [table[0]]
    for level in range(1, nodes.size):
        rises = nodes[level:] - nodes[:-level]
        table = np.diff(table, axis=0) / np.where(rises == 0.0, 1.0, rises)[:, None]
        if level == 1:
            table[::2] = [sample.slope * (w * gap * node ** (w - 1)) for sample, node in zip(taken, t)]
        coefficients.append(table[0])

    def at(place: float) -> Array:
        value: Array = coefficients[-1]
        for node, coefficient in zip(nodes[-2::-1], coefficients[-2::-1]):
            value = (place - node) * value + coefficient
        return value

    return at


def _limit(taken: list[Sample], target: float, weights: Array) -> SingularLimit:
    """The best limit over winding numbers; its error is the change by one sample less, and noise."""
    ends = []
    noise = np.max([sample.noise for sample in taken], axis=0)
    for w in WINDING_NUMBERS:
        value = _polynomial(taken, target, w)(0.0)
        # Leave out the last, then the first sample: one small change may be chance.
        others = [_polynomial(some, target, w)(0.0) for some in (taken[:-1], taken[1:])]
        change = np.max([np.abs(value - other) for other in others], axis=0)
        error = change + AMPLIFICATION[0] * AMPLIFICATION[1] ** w * noise
        error[-1] = 0.0
        ends.append(SingularLimit(np.append(value[:-1], target), largest(error), w, norm(weights, error)))
    known = [end for end in ends if np.isfinite(end.length)]
    if not known:
        raise EvaluationError("the samples of the endgame overflow")
    least = min(end.length for end in known)
    return next(end for end in known if end.length <= EQUALLY_GOOD * least)


def _guess(taken: list[Sample], target: float, lam: float, best: SingularLimit | None) -> Array:
    if best is None:
        last = taken[-1]
        guess: Array = last.u + (lam - last.u[-1]) * last.slope
        return guess
    recent = taken[-3:]
    gap = recent[0].u[-1] - target
    guess = _polynomial(recent, target, best.winding_number)(((lam - target) / gap) ** (1.0 / best.winding_number))
    guess[-1] = lam
    return guess


def _round_off(evaluator: Evaluator, at: Linearization, unit: Array) -> Array:
    """Motion of the point by round-off in H: H a few ulps away, less its linear part.

    The parameter moves, too: near a pole H at one value is as smooth as at any other, and as wrong.
    """
    apply = evaluator.differential(at.u)
    seen = np.zeros_like(at.u)
    if apply is None:
        return seen
    here, ulp = evaluator.residual(at.u), np.spacing(at.u) * np.sign(generic_vector(at.u.size))
    for ulps in ULPS:
        there = at.u + ulps * ulp
        try:
            left = evaluator.residual(there) - here - apply(there - at.u)
        except EvaluationError:
            continue  # A target may lie on the edge of the domain.
        # The largest of many samples is larger.
        seen = np.maximum(seen, 2.0 * np.abs(at.solve(left, 0.0, unit)))
    return seen
