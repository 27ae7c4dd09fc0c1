"""The limit of a path at a target where it is not regular: y ~ y* + c1 t + c2 t^2 + ..., t = |lam - target|^(1/w).

A power-series endgame (Morgan, Sommese and Wampler, Numerische Mathematik 63, 1992) on real paths: points and tangents
are computed for parameter values that fall geometrically towards the target, and the Hermite polynomial through
them in t is evaluated at t = 0, for each winding number w that is tried. Newton's method at the target itself, which
is singular there, is never asked.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from attrs import frozen
from scipy.optimize import brentq

from continuation.arrays import Array
from continuation.correctors import BorderedNewton
from continuation.evaluation import EvaluationError, Evaluator
from continuation.linearization import Linearization, linearize, relinearize
from continuation.predictors.polynomial import interpolate
from continuation.segment import Curve
from continuation.tolerance import Tolerance

RATIO = 0.2
"""Each parameter value is this fraction of the one before: far enough for few points, near enough for Newton."""

ENOUGH = 1e-13
"""A relative error estimate at which no further point is taken: the estimate is the change by the last one."""

WINDING_NUMBERS = (1, 2, 3, 4, 5, 6)


@frozen(eq=False)
class End:
    """The limit of a path.

    Attributes
    ----------
    u : ndarray, shape (N + 1,)
        The parameter is the target exactly.
    error : float
        Estimate of the largest error of a component, absolute.
    winding_number : int
        1 where the path is analytic in the parameter, 2 for a square root, ...
    """

    u: Array
    error: float
    winding_number: int


@frozen(eq=False)
class Sample:
    """A point of the path, and dy/dlam there."""

    u: Array
    slope: Array


def endgame(
    evaluator: Evaluator,
    point: Linearization,
    target: float,
    tolerance: Tolerance,
    max_step: Callable[[Array, Array], float] | None,
    samples: int = 14,
) -> End | None:
    """The limit of the path at the target, or None where no winding number fits to within the tolerance.

    Parameters
    ----------
    point : Linearization
        On the path, near the target, with the parameter moving towards it.
    samples : int
        At most so many points, each of which costs a factorisation or two.
    """
    gap = point.lam - target
    taken = [_sample(point)]
    best: End | None = None
    worse = 0
    here = point
    for k in range(1, samples + 1):
        lam = target + gap * RATIO**k
        following = _track(evaluator, here, _guess(taken, target, lam, best), lam, tolerance, max_step)
        if following is None:
            break
        here = following
        taken.append(_sample(here))
        if len(taken) < 3:
            continue
        end = _limit(taken, target)
        if best is None or end.error < best.error:
            best, worse = end, 0
        else:
            worse += 1
        if best.error <= ENOUGH * (1.0 + float(np.abs(best.u).max())) or worse >= 3:
            break
    if best is None or not tolerance.measure(np.full_like(best.u, best.error), best.u) <= 1.0:
        return None
    return best


def _sample(point: Linearization) -> Sample:
    return Sample(point.u, point.tangent / point.tangent[-1])


def _polynomial(taken: list[Sample], target: float, w: int) -> tuple[Callable[[float], Array], Array]:
    """The Hermite interpolant in t, scaled so that the first sample has t = 1, and the nodes."""
    gap = taken[0].u[-1] - target
    t = np.array([((sample.u[-1] - target) / gap) ** (1.0 / w) for sample in taken])
    slopes = [sample.slope * (w * gap * node ** (w - 1)) for sample, node in zip(taken, t)]
    return interpolate([float(node) for node in t], [sample.u for sample in taken], slopes), t


def _limit(taken: list[Sample], target: float) -> End:
    """The best limit over the winding numbers; the error is the change that the last sample made.

    A multiple of the true winding number fits as well, a little later, so the smallest within a factor of ten wins.
    """
    ends = []
    for w in WINDING_NUMBERS:
        value = _polynomial(taken, target, w)[0](0.0)
        before = _polynomial(taken[:-1], target, w)[0](0.0)
        ends.append(End(np.append(value[:-1], target), float(np.abs(value - before)[:-1].max()), w))
    least = min(end.error for end in ends)
    return next(end for end in ends if end.error <= 10.0 * least)


def _guess(taken: list[Sample], target: float, lam: float, best: End | None) -> Array:
    """The interpolant of the last samples at the next parameter value; at first the tangent."""
    if best is None:
        last = taken[-1]
        guess: Array = last.u + (lam - last.u[-1]) * last.slope
        return guess
    recent = taken[-3:]
    gap = recent[0].u[-1] - target
    curve, _ = _polynomial(recent, target, best.winding_number)
    guess = curve(((lam - target) / gap) ** (1.0 / best.winding_number))
    guess[-1] = lam
    return guess


def _track(
    evaluator: Evaluator,
    here: Linearization,
    guess: Array,
    lam: float,
    tolerance: Tolerance,
    max_step: Callable[[Array, Array], float] | None,
) -> Linearization | None:
    """The point at a parameter value, by Newton at that value, with increments followed to round-off."""
    unit = np.zeros_like(guess)
    unit[-1] = 1.0
    if max_step is not None:
        room = 0.9 * max_step(here.u, guess - here.u)
        if room < 1.0:
            guess = here.u + room * (guess - here.u)
            guess[-1] = lam
    fine = Tolerance(absolute=1e-3 * tolerance.absolute, relative=1e-3 * tolerance.relative)
    correction = BorderedNewton(max_iterations=12, max_contraction=0.9).correct(evaluator, here, guess, unit, fine)
    if not correction.converged:
        return None
    if max_step is not None and not max_step(here.u, correction.u - here.u) > 1.0:
        return None
    correction.u[-1] = lam
    along = here.border
    try:
        if correction.anchor is not None:
            return relinearize(evaluator, correction.u, here.weights, correction.anchor, along)
        return linearize(evaluator, correction.u, here.weights, along, 0)
    except EvaluationError:
        return None


def touching(curve: Curve, point: Linearization, target: float) -> float | None:
    """The step at which a series ahead has the parameter touch the target in a fold; None where it does not.

    To be believed the fold must lie within a twentieth of the remaining way from the target.
    """
    reach = curve.reach
    gap = point.lam - target
    if gap == 0.0 or gap * point.tangent[-1] >= 0.0 or not np.isfinite(reach):
        return None

    def slope(h: float) -> float:
        return float(curve.derivative(h)[-1] * np.sign(gap))

    for low, high in pairwise(np.linspace(0.0, reach, 17)):
        if slope(float(high)) >= 0.0:
            fold = float(brentq(slope, float(low), float(high))) if slope(float(low)) < 0.0 else float(low)
            return fold if abs(curve(fold)[-1] - target) <= 0.05 * abs(gap) else None
        if (curve(float(high))[-1] - target) * gap < -0.05 * gap * gap:
            return None
    return None
