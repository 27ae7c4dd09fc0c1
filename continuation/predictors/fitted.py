"""Series coefficients without jets, by a fit to nearby points."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from continuation.arrays import ROOT_OF_ROUND_OFF, Array
from continuation.contraction import Contraction, Iteration
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.noise import NOISE_LOOKS
from continuation.metric import norm
from continuation.point.linearization import Linearization

FITTED_ORDER = 11
"""Largest order: powers of s magnify round-off by 1e4, by 1e8 at twice the order."""

CHORD = Contraction()
"""Chord steps by the current factorisation; divergence shortens the range."""

ROUNDS = 40
"""Limit of range changes."""


def fitted(
    evaluator: Evaluator,
    point: Linearization,
    order: int,
    first: float,
    reach: Callable[[Array], float],
    accuracy: float,
) -> Array:
    """Return coefficients of the path, shape (k + 1, N + 1), k at most `order` and `FITTED_ORDER`.

    The polynomial has the point's tangent and interpolates points of the path, found by chord steps. `first`: range
    tried first. `reach`: where a series is accurate. `accuracy`: in the metric; noise, doubled by each power, lowers
    the order. `EvaluationError` if no range works.
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
        # In short ranges noise would limit the series.
        following = 0.5 * r if blur else min(0.5 * far, 0.5 * barrier)
        if (r <= 4.0 * far) if blur else (0.25 * far <= r <= far or 0.5 * following <= r <= following):
            break
        r = following
    if last is None:
        raise EvaluationError("no points of the path were found beside this one")
    return last


def _through(evaluator: Evaluator, point: Linearization, order: int, r: float, blur: float) -> Array | None:
    count = order - order % 2  # even: the point is no node
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
        if not (converged or chord.size <= max(ROOT_OF_ROUND_OFF * abs(s), 2.0 * NOISE_LOOKS * blur)):
            return None
        bend = bends[k] = (chord.x - point.u - s * point.tangent) / s**2
    coefficients = np.empty((count + 2, point.u.size))
    coefficients[0], coefficients[1] = point.u, point.tangent
    powers = r ** np.arange(float(count))
    coefficients[2:] = np.linalg.solve(np.vander(nodes, increasing=True), bends) / powers[:, None]
    return coefficients
