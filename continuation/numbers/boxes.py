"""Ranges of functions and derivatives over boxes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.numbers.algebra import GRADIENT, TAYLOR, lengthened
from continuation.numbers.array import Interval
from continuation.numbers.ends import Ends
from continuation.numbers.truncated import wrap


def with_gradient(lo: Array, hi: Array) -> Any:
    """Boxes, shape (boxes, m), as variables with unit vectors as derivatives."""
    count, m = lo.shape
    seeds = np.zeros((1 + m, count, m))
    seeds[np.arange(1, 1 + m), :, np.arange(m)] = 1.0
    low, high = seeds, seeds.copy()
    low[0], high[0] = lo, hi
    return wrap(Ends(low, high), GRADIENT)


def along_curve(value: Ends, first: Ends, half_second: Ends) -> Any:
    """A curve over parameter intervals, from value, derivative and half the second, each (boxes, m)."""
    parts = value, first, half_second
    return wrap(Ends(np.stack([x.lo for x in parts]), np.stack([x.hi for x in parts])), TAYLOR)


def enclose(f: Callable[[Any], Any], lo: Any, hi: Any = None) -> Interval:
    """An enclosure of the range of f over a box.

    Parameters
    ----------
    f : callable
        A function of an array in numpy functions that jets support.
    lo, hi : array_like
        Ends of the box; `hi` defaults to `lo`.

    Returns
    -------
    Interval
        nan where f is undefined on part of the box.

    Raises
    ------
    TypeError
        If f uses an unsupported operation, which is named.
    UndecidedError
        If the box does not decide a comparison in f.
    """
    box = Interval(lo, hi)
    image: Interval = box.lifted(f(box))
    return image


def jacobian(f: Callable[[Any], Any], lo: Any, hi: Any = None) -> Interval:
    """An enclosure of the Jacobian of f: R^m -> R^n over a box, shape (n, m); at kinks the generalized one.

    Parameters
    ----------
    f : callable
        As in `enclose`.
    lo, hi : array_like, shape (m,)

    Raises
    ------
    TypeError, UndecidedError
        As in `enclose`.

    References
    ----------
    Moore, Kearfott and Cloud, Introduction to Interval Analysis (2009); Griewank and Walther (2008).
    """
    box = Interval(lo, hi)
    image = box.lifted(f(with_gradient(box.c.lo[0], box.c.hi[0])))
    slopes: Interval = wrap(Ends(*(x[None] for x in derivatives(image, box.size))), GRADIENT)
    return slopes


def derivatives(image: Interval, m: int) -> tuple[Array, Array]:
    """Ends of an image's derivatives, shape (boxes, *shape, m)."""
    slopes = lengthened(image.c, 1 + m)
    return np.moveaxis(slopes.lo[1:], 0, -1), np.moveaxis(slopes.hi[1:], 0, -1)
