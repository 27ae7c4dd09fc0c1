"""Ranges of elementary functions over intervals; those of their derivatives follow by `continuation.numbers.series`.

Numpy's functions are not correctly rounded. What is assumed of them on this platform is an error of at most 4 units in
the last place of the result; ranges are widened by 8. `tests/continuation/intervals` measures it against 200 digits.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from continuation.arrays import Array
from continuation.numbers.ends import EPS, Ends, Mask, absolute, down, up

LIBRARY_ULPS = 8.0

LARGEST_ANGLE = 1e5
"""Arguments of circular functions beyond this are not reduced: the range is then all of [-1, 1]."""

Function = Callable[[Ends], Ends]


def near(x: float) -> Ends:
    """A number that is rounded to x, or to a neighbour of it."""
    return Ends(down(np.asarray(x)), up(np.asarray(x)))


PI, LN2, LN10 = near(np.pi), near(float(np.log(2.0))), near(float(np.log(10.0)))


def widened(lo: Array, hi: Array) -> Ends:
    """Ends as a library function computed them, moved apart by what it may be wrong; none where one is not finite."""
    apart = Ends(lo - LIBRARY_ULPS * np.spacing(np.abs(lo)), hi + LIBRARY_ULPS * np.spacing(np.abs(hi)))
    return apart.where(np.isfinite(lo) & np.isfinite(hi))


def _between(u: Ends, least: float, most: float) -> Ends:
    return Ends(np.clip(u.lo, least, most), np.clip(u.hi, least, most))


def _increasing(f: Callable[[Array], Array], least: float = -np.inf, most: float = np.inf) -> Function:
    def rule(u: Ends) -> Ends:
        return _between(widened(f(u.lo), f(u.hi)), least, most)

    return rule


def _decreasing(f: Callable[[Array], Array], least: float, most: float) -> Function:
    def rule(u: Ends) -> Ends:
        return _between(widened(f(u.hi), f(u.lo)), least, most)

    return rule


def sqrt(u: Ends) -> Ends:
    """Correctly rounded, by IEEE 754."""
    return Ends(np.maximum(down(np.sqrt(u.lo)), 0.0), up(np.sqrt(u.hi)))


# --- circular and hyperbolic functions --------------------------------------------------------------------


def _meets(u: Ends, offset: float) -> Mask:
    """Whether some (offset + 2 k) pi may lie in u: as the number of turns up to either end, with room for rounding."""
    lo, hi = u.lo / np.pi - offset, u.hi / np.pi - offset
    slack = 8.0 * EPS * (1.0 + u.magnitude())
    found: Mask = np.floor((hi + slack) / 2.0) >= np.ceil((lo - slack) / 2.0)
    return found


def _oscillating(f: Callable[[Array], Array], top: float, bottom: float) -> Function:
    def rule(u: Ends) -> Ends:
        at_lo, at_hi = f(u.lo), f(u.hi)
        ends = widened(np.minimum(at_lo, at_hi), np.maximum(at_lo, at_hi))
        far = u.magnitude() > LARGEST_ANGLE
        lo = np.where(_meets(u, bottom) | far, -1.0, np.maximum(ends.lo, -1.0))
        hi = np.where(_meets(u, top) | far, 1.0, np.minimum(ends.hi, 1.0))
        return Ends(lo, hi).where(np.isfinite(u.lo) & np.isfinite(u.hi))

    return rule


sin, cos = _oscillating(np.sin, 0.5, -0.5), _oscillating(np.cos, 0.0, 1.0)


def tan(u: Ends) -> Ends:
    """No value across a pole."""
    pole = _meets(u, 0.5) | _meets(u, -0.5) | (u.magnitude() > LARGEST_ANGLE)
    return widened(np.tan(u.lo), np.tan(u.hi)).where(~pole)


def cosh(u: Ends) -> Ends:
    """Even: of the sizes."""
    size = absolute(u)
    ends = widened(np.cosh(size.lo), np.cosh(size.hi))
    return Ends(np.maximum(ends.lo, 1.0), ends.hi)


def power(u: Ends, r: float) -> Ends:
    """u**r where r is no whole number, for u > 0."""
    one, other = np.power(u.lo, r), np.power(u.hi, r)
    ends = widened(np.minimum(one, other), np.maximum(one, other))
    return Ends(np.maximum(ends.lo, 0.0), ends.hi).where(u.lo > 0.0)


RANGES: dict[np.ufunc, Function] = {
    np.absolute: absolute,
    np.sqrt: sqrt,
    np.cbrt: _increasing(np.cbrt),
    np.exp: _increasing(np.exp, 0.0),
    np.expm1: _increasing(np.expm1, -1.0),
    np.exp2: _increasing(np.exp2, 0.0),
    np.log: _increasing(np.log),
    np.log1p: _increasing(np.log1p),
    np.log2: _increasing(np.log2),
    np.log10: _increasing(np.log10),
    np.sin: sin,
    np.cos: cos,
    np.tan: tan,
    np.arcsin: _increasing(np.arcsin),
    np.arccos: _decreasing(np.arccos, 0.0, np.inf),
    np.arctan: _increasing(np.arctan),
    np.sinh: _increasing(np.sinh),
    np.cosh: cosh,
    np.tanh: _increasing(np.tanh, -1.0, 1.0),
    np.arcsinh: _increasing(np.arcsinh),
    np.arccosh: _increasing(np.arccosh, 0.0),
    np.arctanh: _increasing(np.arctanh),
}
"""The range of a function, by numpy's name for it."""
