"""The limit of a path at a singular target: y ~ y* + c1 t + c2 t^2 + ..., t = |lam - target|^(1/w).

A power-series endgame (Morgan, Sommese and Wampler, Numerische Mathematik 63, 1992): parameter values approach the
target geometrically, and for each winding number w the Hermite polynomial in t is evaluated at t = 0.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import frozen
from scipy.interpolate import KroghInterpolator

from continuation.arrays import Array, generic_vector, largest
from continuation.contraction import MONOTONE
from continuation.correctors import BorderedNewton
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import POINT_ULPS, Evaluator
from continuation.metric import norm
from continuation.point.arc import cubic_between
from continuation.point.linearization import Linearization, linearize, relinearize
from continuation.point.projection import PathSolver, arc_on_path
from continuation.tolerance import Tolerance

RATIO = 0.2
"""Ratio of distances to the target: few points, each within Newton's reach."""

RELATIVE_FLOOR = 1e-13
"""Relative error that stops the sampling: the change by the last sample."""

WINDING_NUMBERS = (1, 2, 3, 4, 5, 6)

SAMPLES_WITHOUT_GAIN = 3
"""Samples without gain that stop the sampling."""

SAMPLE_TOLERANCE = 1e-3
"""Accuracy of samples, in tolerances, as the extrapolation multiplies their errors; and the largest residual at the
limit, relative to the first sample moved to the target."""

A_DIGIT = 10.0
"""The smallest winding number within this factor of the best error wins: multiples fit as well, later. Round-off in H
may grow so much from the last sample to the limit."""

AT_PARAMETER = BorderedNewton(max_contraction=MONOTONE)
"""Newton's method converges linearly near a singular end."""


@frozen(eq=False)
class SingularLimit:
    """A limit u, shape (N + 1,), exactly at the target.

    `error`: largest error of a component; `length`: the error's in the metric. `winding_number`: 1 if analytic, 2 for a
    square root, ...
    """

    u: Array
    error: float
    winding_number: int
    length: float


Samples = list[tuple[Linearization, Array]]
"""Points, with noise by component."""


@frozen(eq=False)
class Endgame:
    """The search for a limit at a target, with at most `samples` points."""

    solver: PathSolver
    target: float
    samples: int = 14

    def limit(self, point: Linearization) -> SingularLimit | None:
        """The limit, or None if no winding number fits to the tolerance."""
        gap = point.lam - self.target
        taken: Samples = [(point, np.zeros_like(point.u))]
        best: SingularLimit | None = None
        worse = 0
        here = point
        for k in range(1, self.samples + 1):
            lam = self.target + gap * RATIO**k
            if lam == self.target:
                # The parameter has no digits left.
                break
            known = best is not None and self._within(best)
            guess = _polynomial(taken[-3:], self.target, 1 if best is None else best.winding_number)(lam)
            tracked = self._track(here, guess, lam, not known)
            if tracked is None:
                break
            if not self._one_branch(here, tracked[0]):
                # The path turns off: the limit is another branch's.
                return None
            here, noise = tracked
            taken.append((here, noise))
            if len(taken) < 3:
                continue
            end = _limit(taken, self.target, point.weights)
            if best is None or end.length < best.length:
                best, worse = end, 0
            else:
                worse += 1
            if best.length <= RELATIVE_FLOOR or worse >= SAMPLES_WITHOUT_GAIN:
                break
        if best is None or not self._within(best):
            return None
        return best if self._holds(best, taken) and self._keeps_orientation(best, here) else None

    def _one_branch(self, before: Linearization, after: Linearization) -> bool:
        """Whether two samples lie on one branch, as far as known.

        Orientation is constant along a path, and differs on the other of two branches that nearly meet (Allgower and
        Georg, Section 8.1). If unknown, the path between is examined, which detects five of six such ends (seeds in
        test_endgame.py).
        """
        if before.orientation and after.orientation:
            return before.orientation == after.orientation
        arc = cubic_between(before, after, before.border)
        return arc_on_path(self.solver, arc, arc.length) is not None

    def _keeps_orientation(self, end: SingularLimit, last: Linearization) -> bool:
        """Whether a regular limit has the last sample's orientation."""
        if end.winding_number > 1 or last.orientation == 0:
            return True
        try:
            at = relinearize(self.solver.evaluator, end.u, last.weights, last.anchor, last.border, signed=True)
        except EvaluationError:
            return True
        return at.orientation == last.orientation

    def _within(self, end: SingularLimit) -> bool:
        return end.length <= self.solver.tolerance.relative

    def _holds(self, end: SingularLimit, taken: Samples) -> bool:
        """Whether H is round-off at the limit, or far smaller than at the first sample moved there."""
        residual_norm = self.solver.evaluator.residual_norm
        residual, round_off = residual_norm(end.u), residual_norm(taken[-1][0].u)
        moved = residual_norm(np.append(taken[0][0].y, self.target))
        # False if one is nan.
        return residual <= SAMPLE_TOLERANCE * moved + A_DIGIT * round_off

    def _track(self, here: Linearization, guess: Array, lam: float, noisy: bool) -> tuple[Linearization, Array] | None:
        """The point at a parameter value, and its noise.

        If round-off prevents an accurate point and `noisy` allows it, an increment below the tolerance is accepted as
        the noise.
        """
        evaluator, tolerance, max_step = self.solver.evaluator, self.solver.tolerance, self.solver.max_step
        unit = np.zeros_like(guess)
        unit[-1] = 1.0
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
                at = relinearize(evaluator, u, here.weights, anchor, here.border, signed=True)
            else:
                at = linearize(evaluator, u, here.weights, here.border)
            return at, np.maximum(noise, _round_off(evaluator, at, unit))
        except EvaluationError:
            return None


def _polynomial(taken: Samples, target: float, w: int) -> Callable[[float], Array]:
    """The Hermite interpolant of u in t, by the parameter's value."""
    gap = taken[0][0].lam - target
    t = np.array([((point.lam - target) / gap) ** (1.0 / w) for point, _ in taken])
    slopes = [point.tangent / point.tangent[-1] * (w * gap * node ** (w - 1)) for (point, _), node in zip(taken, t)]
    data = [row for (point, _), slope in zip(taken, slopes) for row in (point.u, slope)]
    curve = KroghInterpolator(np.repeat(t, 2), np.array(data))
    return lambda lam: np.append(curve(((lam - target) / gap) ** (1.0 / w))[:-1], lam)


def _limit(taken: Samples, target: float, weights: Array) -> SingularLimit:
    """The best limit over winding numbers; the error is the change by a sample, and noise."""
    ends = []
    noise = np.max([noise for _, noise in taken], axis=0)
    for w in WINDING_NUMBERS:
        value = _polynomial(taken, target, w)(target)
        # Without the last and the first sample: one small change may be chance.
        others = [_polynomial(some, target, w)(target) for some in (taken[:-1], taken[1:])]
        change = np.max([np.abs(value - other) for other in others], axis=0)
        # Sums of Hermite weights' magnitudes at t = 0, nodes in ratio RATIO^(1/w), are 3, 30, 300, ...
        error = change + 0.3 * A_DIGIT**w * noise
        ends.append(SingularLimit(value, largest(error), w, norm(weights, error)))
    known = [end for end in ends if np.isfinite(end.length)]
    if not known:
        raise EvaluationError("the samples of the endgame overflow")
    least = min(end.length for end in known)
    return next(end for end in known if end.length <= A_DIGIT * least)


def _round_off(evaluator: Evaluator, at: Linearization, unit: Array) -> Array:
    """How far round-off in H moves the point: H at a few units in the last place, less its linear part."""
    apply = evaluator.differential(at.u)
    if apply is None:
        return np.zeros_like(at.u)
    nearby = at.u + POINT_ULPS * np.spacing(at.u) * np.sign(generic_vector(at.u.size))
    nearby[-1] = at.u[-1]
    left = evaluator.residual(nearby) - evaluator.residual(at.u) - apply(nearby - at.u)
    # The largest of many samples is larger.
    seen: Array = 2.0 * np.abs(at.solve(left, 0.0, unit))
    return seen
