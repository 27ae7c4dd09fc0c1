"""Ranges of elementary functions over intervals.

NumPy's functions are assumed to err by at most 4 ulps; ranges are widened by 8. `tests/continuation/intervals` compares
with 200 digits.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from continuation.arrays import EPS, Array, Mask
from continuation.numbers.ends import Ends, absolute_range, down, up

LIBRARY_ULPS = 8.0

LARGEST_ANGLE = 1e5
"""Radians; for larger arguments the range is [-1, 1]."""

RangeOf = Callable[[Ends], Ends]


def near(x: float) -> Ends:
    """The interval between x's neighbours, which holds all that rounds to x."""
    return Ends(down(np.asarray(x)), up(np.asarray(x)))


PI, LN2, LN10 = near(np.pi), near(float(np.log(2.0))), near(float(np.log(10.0)))


def widened(lo: Array, hi: Array) -> Ends:
    """Ends moved apart by the library's error; nan if not finite."""
    apart = Ends(lo - LIBRARY_ULPS * np.spacing(np.abs(lo)), hi + LIBRARY_ULPS * np.spacing(np.abs(hi)))
    return apart.where(np.isfinite(lo) & np.isfinite(hi))


def _monotone(f: Callable[[Array], Array], least: float = -np.inf, most: float = np.inf) -> RangeOf:
    def rule(u: Ends) -> Ends:
        one, other = f(u.lo), f(u.hi)
        found = widened(np.minimum(one, other), np.maximum(one, other))
        return Ends(np.clip(found.lo, least, most), np.clip(found.hi, least, most))

    return rule


def sqrt(u: Ends) -> Ends:
    """The range; IEEE 754 rounds it correctly."""
    return Ends(np.maximum(down(np.sqrt(u.lo)), 0.0), up(np.sqrt(u.hi)))


# Circular and hyperbolic functions


def _meets(u: Ends, offset: float) -> Mask:
    """Whether u may contain some (offset + 2 k) pi."""
    lo, hi = u.lo / np.pi - offset, u.hi / np.pi - offset
    slack = 8.0 * EPS * (1.0 + u.magnitude())
    found: Mask = np.floor((hi + slack) / 2.0) >= np.ceil((lo - slack) / 2.0)
    return found


def _oscillating(f: Callable[[Array], Array], top: float, bottom: float) -> RangeOf:
    def rule(u: Ends) -> Ends:
        ends, far = _monotone(f, -1.0, 1.0)(u), u.magnitude() > LARGEST_ANGLE
        lo = np.where(_meets(u, bottom) | far, -1.0, ends.lo)
        hi = np.where(_meets(u, top) | far, 1.0, ends.hi)
        return Ends(lo, hi).where(np.isfinite(u.lo) & np.isfinite(u.hi))

    return rule


sin, cos = _oscillating(np.sin, 0.5, -0.5), _oscillating(np.cos, 0.0, 1.0)


def tan(u: Ends) -> Ends:
    """The range, nan across a pole."""
    pole = _meets(u, 0.5) | _meets(u, -0.5) | (u.magnitude() > LARGEST_ANGLE)
    return _monotone(np.tan)(u).where(~pole)


def power(u: Ends, r: float) -> Ends:
    """u**r for u > 0, r not an integer."""
    return _monotone(lambda x: np.power(x, r), 0.0)(u).where(u.lo > 0.0)


RANGES: dict[np.ufunc, RangeOf] = {
    np.absolute: absolute_range,
    np.sqrt: sqrt,
    np.cbrt: _monotone(np.cbrt),
    np.exp: _monotone(np.exp, 0.0),
    np.expm1: _monotone(np.expm1, -1.0),
    np.exp2: _monotone(np.exp2, 0.0),
    np.log: _monotone(np.log),
    np.log1p: _monotone(np.log1p),
    np.log2: _monotone(np.log2),
    np.log10: _monotone(np.log10),
    np.sin: sin,
    np.cos: cos,
    np.tan: tan,
    np.arcsin: _monotone(np.arcsin),
    np.arccos: _monotone(np.arccos, 0.0, np.inf),
    np.arctan: _monotone(np.arctan),
    np.sinh: _monotone(np.sinh),
    np.cosh: lambda u: _monotone(np.cosh, 1.0)(absolute_range(u)),
    np.tanh: _monotone(np.tanh, -1.0, 1.0),
    np.arcsinh: _monotone(np.arcsinh),
    np.arccosh: _monotone(np.arccosh, 0.0),
    np.arctanh: _monotone(np.arctanh),
}
"""Ranges of functions, by ufunc."""
