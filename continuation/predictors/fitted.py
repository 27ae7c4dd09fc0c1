"""Coefficients of a path's series where its residual is followed by no jet: of points of the path on either side."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from continuation.arrays import Array
from continuation.contraction import HALVING, Contraction, Iteration
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import norm
from continuation.point.linearization import Linearization

FITTED_ORDER = 11
"""Of a fit: with the points that it takes, powers of s magnify round-off by 1e4; by 1e8 with twice as many."""

CHORD = Contraction(iterations=30, ratio=HALVING)
"""With the factorisation at hand; the range is shortened where it does not converge."""

FOUND_BESIDE = 1e-8
"""The last increment of a point beside its distance: next to round-off, whatever the factorisation."""

NOISE_SEEN = 8.0
"""What noise makes of the largest of many increments, in what it makes of one point: each is a difference of two."""

ROUNDS = 40
"""Changes of the range, by four or to half of what the fit says: 4^-40 of a range is none."""


def fitted(
    evaluator: Evaluator,
    point: Linearization,
    order: int,
    first: float,
    reach: Callable[[Array], float],
    accuracy: float,
) -> Array:
    """Coefficients of the path at a point, shape (k + 1, N + 1), k at most `order` and `FITTED_ORDER`.

    The polynomial in the pseudo-arclength that has the point's tangent and goes through points of the path, found by
    Newton's method with the point's factorisation. It lies as near to the path as any in its range, which is chosen to
    be about that in which it is used.

    Parameters
    ----------
    evaluator : Evaluator
    point : Linearization
    order : int
    first : float
        The range that is tried first.
    reach : callable
        How far a series is of use.
    accuracy : float
        In the metric, for that use. Noise in H leaves points of the path uncertain, and the highest of k powers doubles
        that k times: with noise the order is lower.

    Raises
    ------
    EvaluationError
        If there is no range in which the path is found.
    """
    r, barrier, last, blur = first, np.inf, None, 0.0
    order = min(order, FITTED_ORDER)
    if evaluator.noise is not None:
        blur = point.blur(evaluator.noise)
        order = max(min(order, int(math.log2(accuracy / blur))), 2) if 0.0 < blur < accuracy else 2
    for _ in range(ROUNDS):
        found = _through(evaluator, point, order, r, blur)
        if found is None:
            if last is not None:
                break
            barrier, r = r, 0.25 * r
            continue
        last, far = found, reach(found)
        # With noise the longest range will do: in shorter ones it is noise that says how far the series is of use.
        following = 0.5 * r if blur else min(0.5 * far, 0.5 * barrier)
        if (r <= 4.0 * far) if blur else (0.25 * far <= r <= far or 0.5 * following <= r <= following):
            break
        r = following
    if last is None:
        raise EvaluationError("no points of the path were found beside this one")
    return last


def _through(evaluator: Evaluator, point: Linearization, order: int, r: float, blur: float) -> Array | None:
    """The polynomial through points at Chebyshev's nodes within r, known to a blur; None where one is not found."""
    count = order - order % 2  # an even number: none of them is the point itself
    nodes = np.cos((np.arange(count) + 0.5) * (np.pi / count))
    bends = np.empty((count, point.u.size))
    bend = np.zeros_like(point.u)
    for k in np.argsort(np.abs(nodes), kind="stable"):
        s = r * float(nodes[k])
        chord = Iteration(point.u + s * (point.tangent + s * bend), CHORD)

        def increment(chord: Iteration = chord) -> Array:
            return point.approximate(-evaluator.residual(chord.x))

        def size(step: Array) -> float:
            return norm(point.weights, step)

        def done(last: float, s: float = s) -> bool:
            return last <= 1e-15 * abs(s)

        try:
            converged = chord.run(increment, size, done)
        except EvaluationError:
            return None
        if not (converged or chord.size <= max(FOUND_BESIDE * abs(s), NOISE_SEEN * blur)):
            return None
        bend = bends[k] = (chord.x - point.u - s * point.tangent) / s**2
    coefficients = np.empty((count + 2, point.u.size))
    coefficients[0], coefficients[1] = point.u, point.tangent
    powers = r ** np.arange(float(count))
    coefficients[2:] = np.linalg.solve(np.vander(nodes, increasing=True), bends) / powers[:, None]
    return coefficients
