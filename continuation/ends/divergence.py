"""Whether a path runs off to infinity while the parameter stops: a model of its asymptote, predicted further and met.

On a pole y ~ (limit - lam)^-p, and on a logarithm, p = 0, slopes dy/dlam grow like (limit - lam)^-(p + 1). Three points
give p and the limit; the model counts where it says where the parameter is at the next ones, until that is the
limit itself to nearly all digits. Fast growth alone says nothing: a pitchfork with an imperfection of 1e-14 looks like
a pole until the parameter is as near as 1e-9 of its way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from continuation.arrays import Array, largest
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import Linearization, linearize
from continuation.predictors import Knot

DECADE = 10.0
"""The slope grows by this factor, or more, from one point of the model to the next."""

MET = 0.1
"""What a prediction may be off, beside the way of the parameter that it predicts: a tenth of a decade."""

MET_OVER = 1e-2
"""A model is tried further after the parameter has come nearer to the limit by this factor while all predictions were
met."""

ARRIVED, LAST_PLACES = 1e-11, 8.0
"""It is tried until the parameter is so near to its limit, beside all its way or in units of its last place: imperfect
pitchforks turn off at the power 2/3 of the imperfection, so those above 1e-16 do not come so near."""

ASYMPTOTE_STEPS = 5
"""From a prediction that is off by a tenth of what is left four steps are quadratic to all digits."""

LARGER = 2.0
"""On a pole the largest unknown, in plain numbers, is so many times as large as at the start: what grows from 1e-20 to
1e-8 beside others that are 1 may be bounded by them."""

HORIZON = 1e100
"""No path is followed to larger numbers: norms are made of their squares, which overflow."""

ASYMPTOTE_ORDERS = 0.9, 13.0
"""Between these p + 1 is sought: at folds and cusps it is 1/2 or less, and no pole of a model has an order above 12."""

LOGARITHM = 13.0 / 12.0
"""p + 1 of a pole of order 1/12; what is nearer to 1 is a logarithm, or an exponential decay."""

ABOUT = 0.02
"""Three points give an order to two digits: one that is so near to a whole number, or to its inverse, is that."""

PRINTED_DIGITS = 9
"""Of the parameter's way, in messages."""

Monitor = tuple[float, ...]


def divergence(
    monitor: Monitor, point: Linearization, origin: Knot, evaluator: Evaluator, stops: Sequence[tuple[int, float]]
) -> tuple[Monitor, str]:
    """Follow the slope of the path by decades; the monitor afterwards, and which infinity it is in words, if any.

    Parameters
    ----------
    monitor : tuple of float
        (the parameter's way so far; the distance to the limit where predictions began to be met, 0 if none was;
        parameter and slope at the last marks, three at most); empty at the start.
    point : Linearization
    origin : Knot
        The start: slopes are measured in how far each unknown has come from it.
    evaluator : Evaluator
    stops : sequence of (component, value)
        Where the path is to end: what comes to one of them on the way runs off to no infinity.
    """
    lam, moves = point.lam, float(point.tangent[-1])
    way, began, *marks = monitor or (0.0, 0.0)
    way = max(way, abs(lam - float(origin.u[-1])))
    slope = largest(point.tangent[:-1]) / abs(moves) if moves else math.inf
    if marks and (slope < marks[-1] or (len(marks) > 2 and (lam - marks[-2]) * (marks[-2] - marks[-4]) < 0.0)):
        # Slower again, or back: what was seen is behind.
        return (way, 0.0), ""
    if not 0.0 < slope < math.inf or (marks and slope < DECADE * marks[-1]):
        return (way, began, *marks), ""
    model, met = _fitted(marks), False
    if model is not None:
        limit, order = model
        ahead = (limit - marks[-2]) * (1.0 - (marks[-1] / slope) ** (1.0 / order))
        met = abs(lam - marks[-2] - ahead) <= MET * abs(ahead) + LAST_PLACES * float(np.spacing(abs(lam)))
        began = (began or abs(limit - marks[-2])) if met else 0.0
    marks = [*marks, lam, slope][-6:]
    known, model = (way, began, *marks), _fitted(marks) or model
    if not met or model is None or abs(model[0] - lam) > MET_OVER * began:
        return known, ""
    bounded = model[1] > LOGARITHM and largest(point.y) < LARGER * largest(origin.u[:-1])
    return known, words(known) if not bounded and _met_further(evaluator, point, *model, way, stops) else ""


def _met_further(
    evaluator: Evaluator,
    point: Linearization,
    limit: float,
    order: float,
    way: float,
    stops: Sequence[tuple[int, float]],
) -> bool:
    """Whether the path is where the model says decade by decade, until the parameter is at its limit.

    Newton's method along the path's hyperplane from each prediction must come to a point whose parameter is no more
    than a tenth of what is left away; its slope predicts the next.
    """
    enough = ARRIVED * way + LAST_PLACES * float(np.spacing(abs(limit)))
    power, at = order - 1.0, point
    try:
        while (left := limit - at.lam) and abs(left) > enough:
            nearer = left / DECADE
            # The integral of a slope that goes like the power -(p + 1) of what is left.
            grown = math.log(DECADE) if abs(power) < ABOUT else (DECADE**power - 1.0) / power
            u = at.u + at.tangent / at.tangent[-1] * (left * grown)
            u[-1] = limit - nearer
            for _ in range(ASYMPTOTE_STEPS):
                step = linearize(evaluator, u, at.weights, at.border).solve(-evaluator.residual(u), 0.0, at.border)
                u = u + step
            if not abs(u[-1] - limit + nearer) <= MET * abs(nearer) or abs(step[-1]) > MET * abs(nearer):
                return False
            at = linearize(evaluator, u, at.weights, at.border)
    except (EvaluationError, ZeroDivisionError, OverflowError):
        return False
    return not any((value - point.u[i]) * (at.u[i] - value) > 0.0 for i, value in stops)


def beyond_horizon(u: Array) -> str:
    """The limit of the budget that numbers are, as text, if a point has come to it."""
    return f"numbers of {largest(u):.0e}" if largest(u) >= HORIZON else ""


def words(monitor: Monitor) -> str:
    """What asymptote is in sight, in words; "" if none is."""
    if not monitor or monitor[1] == 0.0:
        return ""
    way, _, *marks = monitor
    model = _fitted(marks)
    if model is None:
        return ""
    limit, order = model
    digits = PRINTED_DIGITS - math.floor(math.log10(way)) if way > 0.0 else PRINTED_DIGITS
    lam = f"{round(limit, digits) + 0.0:.{PRINTED_DIGITS}g}"
    p = order - 1.0
    if order <= LOGARITHM:
        return f"An asymptote: the parameter tends to {lam} and stands still while the unknowns grow, like a logarithm."
    whole = round(p) if p >= 1.0 else 1.0 / round(1.0 / p)
    return f"A pole: the unknowns grow like |lam - {lam}|^-{whole if abs(p / whole - 1.0) <= ABOUT else p:.2g}."


def _fitted(marks: list[float]) -> tuple[float, float] | None:
    """The limit of the parameter, and p + 1, of the slopes (limit - lam)^-(p + 1) through three marks, if any."""
    if len(marks) < 6:
        return None
    first, a, second, b, third, c = marks
    if second == first:
        return None
    ratio = (third - second) / (second - first)

    def missed(order: float) -> float:
        # Distances to the limit, that of the first being 1.
        left, last = (a / b) ** (1.0 / order), (a / c) ** (1.0 / order)
        return float((left - last) / (1.0 - left) - ratio)

    if not missed(ASYMPTOTE_ORDERS[0]) < 0.0 < missed(ASYMPTOTE_ORDERS[1]):
        return None
    order = float(brentq(missed, *ASYMPTOTE_ORDERS))
    gone = (a / c) ** (1.0 / order)
    return first + (third - first) / (1.0 - gone), order
