"""Whether a path runs off to infinity, and how: in the projective coordinates (1 : u - start), in any units.

Fast growth alone says nothing: y = 1e8 lam is a straight line. What counts is that the direction of the path tends to a
point at infinity at which the parameter stands still beside it.
"""

from __future__ import annotations

import math

from continuation.arrays import Array
from continuation.metric import norm
from continuation.predictors import Knot

DECADE = 10.0
"""The distance from the start grows by this factor between two looks at the parameter."""

STILL, DECADES = 1e-3, 3
"""The parameter stands still when, in so many decades in a row, it moves by less than this part of all its way: a pole
of order 6 or lower slows down by less than that in three."""

FROZEN = 1e-12
"""When it moves by less than this in one decade of the distance it is not going anywhere: an exponential asymptote."""

HORIZON = 1e12
"""The distance, in extents at the start, beyond which a path is at infinity, whatever its parameter does."""

POWERS = 0.05
"""A pole's parameter nears its limit by a steady factor from decade to decade, at least this one for an order up to
0.77; one that falls faster is no pole."""


def divergence(
    monitor: tuple[float, ...], u: Array, origin: Knot, origin_weights: Array
) -> tuple[tuple[float, ...], str]:
    """Follow the distance from the start by decades; the monitor afterwards, and what is found in words, if anything.

    Parameters
    ----------
    monitor : tuple of float
        (distance and parameter at the last mark, decades stalled, the parameter's way so far, and its way in the last
        decade); empty at the start.
    u : ndarray, shape (N + 1,)
    origin : Knot
        The start.
    origin_weights : ndarray, shape (N + 1,)
        The metric there.
    """
    distance, lam, lam0 = norm(origin_weights, u - origin.u), float(u[-1]), float(origin.u[-1])
    mark, before, stalled, way, last = monitor or (1.0, lam0, 0.0, 0.0, math.nan)
    way = max(way, abs(lam - lam0))
    if distance < DECADE * mark:
        return (mark, before, stalled, way, last), ""
    moved = lam - before
    stalled = stalled + (DECADES if abs(moved) <= FROZEN * way else 1.0) if abs(moved) <= STILL * way else 0.0
    words = ""
    if stalled >= DECADES:
        words = _limit(lam, moved, last)
    elif distance > HORIZON:
        words = f"It is {distance:.0e} times as far from its start as where it first turned."
    return (distance, lam, stalled, way, moved), words


def _limit(lam: float, moved: float, last: float) -> str:
    """Which infinity: the parameter's ways in the last two decades extrapolated (Aitken)."""
    ratio = moved / last if last else 0.0
    if not POWERS <= ratio < 1.0:
        return f"An asymptote: the parameter tends to {lam:.9g} and stands still while the unknowns grow."
    limit, order = lam + moved * ratio / (1.0 - ratio), -1.0 / math.log10(ratio)
    return f"A pole: the unknowns grow like |lam - {limit:.9g}|^-{order:.2g}."
