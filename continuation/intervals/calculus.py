"""Ranges of functions and of their derivatives over boxes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.intervals.array import CURVE, GRADIENT, Interval, as_interval, wrap
from continuation.intervals.ends import Ends


def boxes(lo: Array, hi: Array) -> Interval:
    """Many boxes as one array: shape (m,) for ends of shape (boxes, m).

    Parameters
    ----------
    lo, hi : ndarray, shape (boxes, *shape)
    """
    return wrap(Ends(lo[None], hi[None]), GRADIENT)


def with_gradient(lo: Array, hi: Array) -> Interval:
    """The boxes as variables, with the unit vectors as their derivatives: `lo`, `hi` of shape (boxes, m)."""
    count, m = lo.shape
    seeds = np.zeros((1 + m, count, m))
    seeds[np.arange(1, 1 + m), :, np.arange(m)] = 1.0
    low, high = seeds, seeds.copy()
    low[0], high[0] = lo, hi
    return wrap(Ends(low, high), GRADIENT)


def along_curve(value: Ends, first: Ends, half_second: Ends) -> Interval:
    """A curve over intervals of its parameter: value, derivative and half the second one, of shape (boxes, m) each."""
    parts = value, first, half_second
    return wrap(Ends(np.stack([x.lo for x in parts]), np.stack([x.hi for x in parts])), CURVE)


def enclose(f: Callable[[Any], Any], lo: Any, hi: Any = None) -> Interval:
    """The range of f over a box, or an interval array that holds it.

    Parameters
    ----------
    f : callable
        A function of an array, written in numpy functions that interval arrays know (those that jets know).
    lo, hi : array_like
        Ends of the box; one point unless `hi` is given.

    Returns
    -------
    Interval
        nan where f is not defined everywhere in the box.

    Raises
    ------
    TypeError
        Where f uses an operation that interval arrays do not know; the message names it.
    UndecidedError
        Where f compares numbers and the box does not decide.
    """
    return as_interval(f(Interval(lo, hi)))


def jacobian(f: Callable[[Any], Any], lo: Any, hi: Any = None) -> Interval:
    """The range of the Jacobian of f: R^m -> R^n over a box, shape (n, m): of the generalized one where f has kinks.

    Parameters
    ----------
    f : callable
        As in `enclose`.
    lo, hi : array_like, shape (m,)

    Returns
    -------
    Interval

    Raises
    ------
    TypeError, UndecidedError
        As in `enclose`.

    References
    ----------
    Moore, Kearfott and Cloud, Introduction to Interval Analysis (2009); forward derivatives as in Griewank and
    Walther (2008).
    """
    box = Interval(lo, hi)
    ends = box.ends
    image = as_interval(f(with_gradient(ends.lo[0], ends.hi[0])))
    lower, upper = derivatives(image, box.size)
    return boxes(lower, upper)


def derivatives(image: Interval, m: int) -> tuple[Array, Array]:
    """Lower and upper ends of the derivatives of an image, shape (boxes, *shape, m); zero for a constant."""
    lo, hi = image.ends.lo[1:], image.ends.hi[1:]
    if len(lo) == 0:
        lo = hi = np.zeros((m, *image.ends.shape[1:]))
    return np.moveaxis(lo, 0, -1), np.moveaxis(hi, 0, -1)
