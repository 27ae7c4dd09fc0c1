"""Whether a path runs off to infinity, and how: in the projective coordinates (1 : u - start), in any units.

Fast growth alone says nothing: y = 1e8 lam is a straight line. What counts is that the direction of the path tends to a
point at infinity at which the parameter stands still beside it.
"""

from __future__ import annotations

import math

from scipy.optimize import brentq

from continuation.arrays import Array
from continuation.metric import norm
from continuation.predictors import Knot

DECADE = 10.0
"""The distance from the start grows by this factor between two looks at the parameter."""

STANDS_STILL_PART, DECADES = 1e-3, 3
"""The parameter stands still when, in so many decades in a row, it moves by less than this part of all its way: a pole
of order 6 or lower slows down by less than that in three."""

FROZEN = 1e-12
"""When it moves by less than this in one decade of the distance it is not going anywhere: an exponential asymptote."""

HORIZON = 1e12
"""The distance, in extents at the start, beyond which a path is at infinity, whatever its parameter does."""

POLE_ORDERS = 1.0 / 12.0, 12.0
"""Orders of poles that are told from an asymptote; a logarithm or an exponential looks like one beyond."""

ABOUT = 0.02
"""Three points give an order to two digits: one that is so near to a whole number, or to its inverse, is that."""

PRINTED_DIGITS = 9
"""Of the parameter's way, in messages."""


def divergence(
    monitor: tuple[float, ...], u: Array, origin: Knot, origin_weights: Array
) -> tuple[tuple[float, ...], str]:
    """Follow the distance from the start by decades; the monitor afterwards, and what is found in words, if anything.

    Parameters
    ----------
    monitor : tuple of float
        (distance and parameter at the last mark, decades stalled, the parameter's way so far, distance and parameter
        at the mark before); empty at the start.
    u : ndarray, shape (N + 1,)
    origin : Knot
        The start.
    origin_weights : ndarray, shape (N + 1,)
        The metric there.
    """
    distance, lam, lam0 = norm(origin_weights, u - origin.u), float(u[-1]), float(origin.u[-1])
    mark, before, stalled, way, *earlier = monitor or (1.0, lam0, 0.0, 0.0, 0.0, lam0)
    way = max(way, abs(lam - lam0))
    if distance < DECADE * mark:
        return (mark, before, stalled, way, *earlier), ""
    moved = abs(lam - before)
    stalled = stalled + (DECADES if moved <= FROZEN * way else 1.0) if moved <= STANDS_STILL_PART * way else 0.0
    words = ""
    if stalled >= DECADES:
        words = _limit((earlier[0], mark, distance), (earlier[1], before, lam), way)
    elif distance > HORIZON:
        words = f"It is {distance:.0e} times as far from its start as where it first turned."
    return (distance, lam, stalled, way, mark, before), words


def _limit(distances: tuple[float, float, float], lams: tuple[float, float, float], way: float) -> str:
    """Which infinity: lam - limit ~ distance^(-1 / order) through three points, where an order fits."""

    def decay(power: float) -> float:
        a, b, c = ((d / distances[0]) ** -power for d in distances)
        return float((c - b) / (b - a))

    def rounded(lam: float) -> str:
        if way == 0.0:
            return f"{lam:.{PRINTED_DIGITS}g}"
        return f"{round(lam, PRINTED_DIGITS - math.floor(math.log10(way))) + 0.0:.{PRINTED_DIGITS}g}"

    (first, second, third), (least, most) = lams, POLE_ORDERS
    ratio = (third - second) / (second - first) if second != first else 0.0
    if distances[0] == 0.0 or abs(third - second) <= FROZEN * way or not decay(1.0 / least) < ratio < decay(1.0 / most):
        return f"An asymptote: the parameter tends to {rounded(third)} and stands still while the unknowns grow."
    power = float(brentq(lambda p: decay(p) - ratio, 1.0 / most, 1.0 / least))
    a, b = (distances[1] / distances[0]) ** -power, (distances[2] / distances[0]) ** -power
    limit = third + (third - second) * b / (a - b)
    whole = round(1.0 / power) if power <= 1.0 else 1.0 / round(power)
    order = whole if abs(power * whole - 1.0) <= ABOUT else 1.0 / power
    return f"A pole: the unknowns grow like |lam - {rounded(limit)}|^-{order:.2g}."
