"""Whether a path goes to infinity while the parameter stops.

On a pole y ~ (limit - lam)^-p, or a logarithm (p = 0), slopes grow like (limit - lam)^-(p + 1); three points give p and
the limit. The model must predict the path, as fast growth is no proof: a pitchfork with an imperfection of 1e-14
resembles a pole down to 1e-9 of the parameter's way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from continuation.arrays import Array, largest
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import POINT_ULPS, Evaluator
from continuation.point.linearization import Linearization, linearize
from continuation.predictors import Knot

DECADE = 10.0
"""Least growth of the slope between marks. A prediction may err by a tenth of the change; the model is tried further
once the distance to the limit fell by two decades."""

ARRIVED = 1e-11
"""The model is followed to this distance from the limit, relative to the parameter's way, or to twice its round-off:
only pitchforks with imperfections below 1e-16 come so near."""

QUADRATIC_STEPS = 4
"""Newton steps: from an error of a tenth, four give all digits."""

LARGER = 2.0
"""Least growth of the largest unknown on a pole."""

HORIZON = 1e100
"""Largest number on a path, whose square is finite."""

HIGHEST_POLE = 12.0
"""Largest order p of a pole, and of its inverse: smaller means a logarithm or an exponential decay."""

Monitor = tuple[float, ...]


def divergence(
    monitor: Monitor, point: Linearization, origin: Knot, evaluator: Evaluator, stops: Sequence[tuple[int, float]]
) -> tuple[Monitor, str]:
    """Update the monitor with a point; return the sentence that names the infinity, or "".

    `monitor`, empty at first: the parameter's way; the distance to the limit at which predictions began to hold, or 0;
    parameter and slope at up to three marks. `stops`: pairs (component, value) that end the path; one on the way
    excludes infinity.
    """
    lam, moves = point.lam, float(point.tangent[-1])
    way, began, *marks = monitor or (0.0, 0.0)
    way = max(way, abs(lam - float(origin.u[-1])))
    slope = largest(point.tangent[:-1]) / abs(moves) if moves else math.inf
    if marks and (slope < marks[-1] or (len(marks) > 2 and (lam - marks[-2]) * (marks[-2] - marks[-4]) < 0.0)):
        # The path is slower or goes back: forget the model.
        return (way, 0.0), ""
    if not 0.0 < slope < math.inf or (marks and slope < DECADE * marks[-1]):
        return (way, began, *marks), ""
    model, met = _fitted(marks), False
    if model is not None:
        limit, order = model
        ahead = (limit - marks[-2]) * (1.0 - (marks[-1] / slope) ** (1.0 / order))
        met = abs(lam - marks[-2] - ahead) <= abs(ahead) / DECADE + 2.0 * POINT_ULPS * float(np.spacing(abs(lam)))
        began = (began or abs(limit - marks[-2])) if met else 0.0
    marks = [*marks, lam, slope][-6:]
    known, model = (way, began, *marks), _fitted(marks) or model
    if not met or model is None or abs(model[0] - lam) > began / DECADE**2:
        return known, ""
    bounded = model[1] > 1.0 + 1.0 / HIGHEST_POLE and largest(point.y) < LARGER * largest(origin.u[:-1])
    return known, words(known) if not bounded and _met_further(evaluator, point, *model, way, stops) else ""


def _met_further(
    evaluator: Evaluator,
    point: Linearization,
    limit: float,
    order: float,
    way: float,
    stops: Sequence[tuple[int, float]],
) -> bool:
    """Whether Newton's method confirms the model's predictions, decade by decade."""
    enough = ARRIVED * way + 2.0 * POINT_ULPS * float(np.spacing(abs(limit)))
    power, at = order - 1.0, point
    try:
        while (left := limit - at.lam) and abs(left) > enough:
            nearer = left / DECADE
            # The slope is proportional to the power -(p + 1) of the distance.
            grown = math.expm1(power * math.log(DECADE)) / power if power else math.log(DECADE)
            u = at.u + at.tangent / at.tangent[-1] * (left * grown)
            u[-1] = limit - nearer
            for _ in range(QUADRATIC_STEPS):
                step = linearize(evaluator, u, at.weights, at.border).solve(-evaluator.residual(u), 0.0, at.border)
                u = u + step
            if not abs(u[-1] - limit + nearer) <= abs(nearer / DECADE) or abs(step[-1]) > abs(nearer / DECADE):
                return False
            at = linearize(evaluator, u, at.weights, at.border)
    except (EvaluationError, ZeroDivisionError, OverflowError):
        return False
    return not any((value - point.u[i]) * (at.u[i] - value) > 0.0 for i, value in stops)


def beyond_horizon(u: Array) -> str:
    """Size of a point beyond HORIZON, as text, or ""."""
    return f"numbers of {largest(u):.0e}" if largest(u) >= HORIZON else ""


def words(monitor: Monitor) -> str:
    """The asymptote in words; "" if none."""
    if not monitor or monitor[1] == 0.0:
        return ""
    way, _, *marks = monitor
    model = _fitted(marks)
    if model is None:
        return ""
    limit, order = model
    lam = f"{round(limit, 9 - math.floor(math.log10(way or 1.0))) + 0.0:.9g}"
    p = order - 1.0
    if order <= 1.0 + 1.0 / HIGHEST_POLE:
        return f"An asymptote: the parameter tends to {lam} and stands still while the unknowns grow, like a logarithm."
    # Three points give two digits of the order.
    whole = round(p) if p >= 1.0 else 1.0 / round(1.0 / p)
    return f"A pole: the unknowns grow like |lam - {lam}|^-{whole if abs(p / whole - 1.0) <= 0.02 else p:.2g}."


def _fitted(marks: list[float]) -> tuple[float, float] | None:
    """The limit and p + 1 from three marks, or None."""
    if len(marks) < 6:
        return None
    first, a, second, b, third, c = marks
    if second == first:
        return None
    ratio = (third - second) / (second - first)

    def missed(order: float) -> float:
        # Distances to the limit, relative to the first.
        left, last = (a / b) ** (1.0 / order), (a / c) ** (1.0 / order)
        return float((left - last) / (1.0 - left) - ratio)

    orders = 1.0 - 1.0 / HIGHEST_POLE, 1.0 + HIGHEST_POLE
    if not missed(orders[0]) < 0.0 < missed(orders[1]):
        return None
    order = float(brentq(missed, *orders))
    gone = (a / c) ** (1.0 / order)
    return first + (third - first) / (1.0 - gone), order
