"""Ranges of elementary functions over intervals, and those of their first two derivatives.

Numpy's functions are not correctly rounded. What is assumed of them on this platform is an error of at most 4 units in
the last place of the result; ranges are widened by 8. `tests/continuation/intervals` measures it against 200 digits.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.intervals.ends import EPS, Ends, Mask, absolute, down, thin, up, whole_power

ULPS = 8.0

LARGEST_ANGLE = 1e5
"""Arguments of circular functions beyond this are not reduced: the range is then all of [-1, 1]."""

Function = Callable[[Ends], Ends]


@frozen(eq=False)
class Rule:
    """A function of one argument: the range of its values, and of its derivatives for argument u and value f(u)."""

    value: Function
    first: Callable[[Ends, Ends], Ends]
    second: Callable[[Ends, Ends], Ends]


def constant(x: float, like: Ends) -> Ends:
    """The number x, in the shape of `like`."""
    return thin(np.full(like.shape, x))


def _near(x: float) -> Ends:
    """A number that is rounded to x, or to a neighbour of it."""
    return Ends(down(np.full((1, 1), x)), up(np.full((1, 1), x)))


PI, LN2, LN10 = _near(np.pi), _near(float(np.log(2.0))), _near(float(np.log(10.0)))


def widened(lo: Array, hi: Array) -> Ends:
    """Ends as a library function computed them, moved apart by what it may be wrong; none where one is not finite."""
    apart = Ends(lo - ULPS * np.spacing(np.abs(lo)), hi + ULPS * np.spacing(np.abs(hi)))
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


# --- derivatives ------------------------------------------------------------------------------------------


def _one(u: Ends) -> Ends:
    return constant(1.0, u)


def _times(factor: float, u: Ends) -> Ends:
    return constant(factor, u) * u


def _reciprocal(u: Ends) -> Ends:
    return _one(u) / u


def _complement(u: Ends) -> Ends:
    """1 - u**2, its factors apart, so that nothing cancels near its zeros."""
    return (_one(u) - u) * (_one(u) + u)


def _sum_of_squares(u: Ends) -> Ends:
    return _one(u) + whole_power(u, 2)


def _minus_one(u: Ends) -> Ends:
    """u**2 - 1."""
    return (u - _one(u)) * (u + _one(u))


def _logarithmic(scale: Ends | None, shift: float = 0.0) -> tuple[Callable[[Ends, Ends], Ends], ...]:
    """Derivatives of log(u + shift) / scale."""

    def first(u: Ends, v: Ends) -> Ends:
        slope = _reciprocal(u + constant(shift, u) if shift else u)
        return slope if scale is None else slope / scale

    def second(u: Ends, v: Ends) -> Ends:
        slope = -whole_power(_reciprocal(u + constant(shift, u) if shift else u), 2)
        return slope if scale is None else slope / scale

    return first, second


def _three_halves(u: Ends) -> Ends:
    return u * sqrt(u)


def _sign(u: Ends) -> Ends:
    """The generalized derivative of |u|: both slopes where u may be zero."""
    sign = Ends(np.where(u.lo > 0.0, 1.0, -1.0), np.where(u.hi < 0.0, -1.0, 1.0))
    return sign.where(~np.isnan(u.lo))


def _curvature_of_size(u: Ends, v: Ends) -> Ends:
    """None at a kink."""
    return thin(np.zeros(u.shape)).where((u.lo > 0.0) | (u.hi < 0.0))


def _cbrt_first(u: Ends, v: Ends) -> Ends:
    return v / _times(3.0, u)


def _cbrt_second(u: Ends, v: Ends) -> Ends:
    return _times(-2.0, v) / _times(9.0, u * u)


_EXP = _increasing(np.exp, 0.0)
_TANH = _increasing(np.tanh, -1.0, 1.0)

RULES: dict[str, Rule] = {
    "positive": Rule(lambda u: u, lambda u, v: _one(u), lambda u, v: constant(0.0, u)),
    "absolute": Rule(absolute, lambda u, v: _sign(u), _curvature_of_size),
    "fabs": Rule(absolute, lambda u, v: _sign(u), _curvature_of_size),
    "square": Rule(lambda u: whole_power(u, 2), lambda u, v: _times(2.0, u), lambda u, v: constant(2.0, u)),
    "sqrt": Rule(sqrt, lambda u, v: _reciprocal(_times(2.0, v)), lambda u, v: -_reciprocal(_times(4.0, u * v))),
    "cbrt": Rule(_increasing(np.cbrt), _cbrt_first, _cbrt_second),
    "reciprocal": Rule(_reciprocal, lambda u, v: -whole_power(v, 2), lambda u, v: _times(2.0, whole_power(v, 3))),
    "exp": Rule(_EXP, lambda u, v: v, lambda u, v: v),
    "expm1": Rule(_increasing(np.expm1, -1.0), lambda u, v: _EXP(u), lambda u, v: _EXP(u)),
    "exp2": Rule(_increasing(np.exp2, 0.0), lambda u, v: LN2 * v, lambda u, v: LN2 * LN2 * v),
    "log": Rule(_increasing(np.log), *_logarithmic(None)),
    "log1p": Rule(_increasing(np.log1p), *_logarithmic(None, 1.0)),
    "log2": Rule(_increasing(np.log2), *_logarithmic(LN2)),
    "log10": Rule(_increasing(np.log10), *_logarithmic(LN10)),
    "sin": Rule(sin, lambda u, v: cos(u), lambda u, v: -v),
    "cos": Rule(cos, lambda u, v: -sin(u), lambda u, v: -v),
    "tan": Rule(tan, lambda u, v: _sum_of_squares(v), lambda u, v: _times(2.0, v) * _sum_of_squares(v)),
    "arcsin": Rule(
        _increasing(np.arcsin),
        lambda u, v: _reciprocal(sqrt(_complement(u))),
        lambda u, v: u / _three_halves(_complement(u)),
    ),
    "arccos": Rule(
        _decreasing(np.arccos, 0.0, np.inf),
        lambda u, v: -_reciprocal(sqrt(_complement(u))),
        lambda u, v: -(u / _three_halves(_complement(u))),
    ),
    "arctan": Rule(
        _increasing(np.arctan),
        lambda u, v: _reciprocal(_sum_of_squares(u)),
        lambda u, v: _times(-2.0, u) / whole_power(_sum_of_squares(u), 2),
    ),
    "sinh": Rule(_increasing(np.sinh), lambda u, v: cosh(u), lambda u, v: v),
    "cosh": Rule(cosh, lambda u, v: _increasing(np.sinh)(u), lambda u, v: v),
    "tanh": Rule(_TANH, lambda u, v: _complement(v), lambda u, v: _times(-2.0, v) * _complement(v)),
    "arcsinh": Rule(
        _increasing(np.arcsinh),
        lambda u, v: _reciprocal(sqrt(_sum_of_squares(u))),
        lambda u, v: -(u / _three_halves(_sum_of_squares(u))),
    ),
    "arccosh": Rule(
        _increasing(np.arccosh, 0.0),
        lambda u, v: _reciprocal(sqrt(_minus_one(u))),
        lambda u, v: -(u / _three_halves(_minus_one(u))),
    ),
    "arctanh": Rule(
        _increasing(np.arctanh),
        lambda u, v: _reciprocal(_complement(u)),
        lambda u, v: _times(2.0, u) / whole_power(_complement(u), 2),
    ),
}
"""By numpy's names."""


def power_rule(exponent: float) -> Rule:
    """u**exponent for a constant exponent; where it is no whole number, for u > 0."""
    r = float(exponent)
    if r == int(r):
        return _whole_rule(int(r))

    def value(u: Ends) -> Ends:
        ends = np.power(u.lo, r), np.power(u.hi, r)
        out = widened(*(ends if r > 0.0 else ends[::-1]))
        return Ends(np.maximum(out.lo, 0.0), out.hi).where(u.lo > 0.0)

    def first(u: Ends, v: Ends) -> Ends:
        return constant(r, u) * v / u

    def second(u: Ends, v: Ends) -> Ends:
        return constant(r, u) * (constant(r, u) - _one(u)) * v / (u * u)

    return Rule(value, first, second)


def _whole_rule(n: int) -> Rule:
    def value(u: Ends, n: int = n) -> Ends:
        return whole_power(u, n) if n >= 0 else _reciprocal(whole_power(u, -n))

    def first(u: Ends, v: Ends) -> Ends:
        return constant(0.0, u) if n == 0 else _times(n, value(u, n - 1))

    def second(u: Ends, v: Ends) -> Ends:
        return constant(0.0, u) if n in (0, 1) else _times(n * (n - 1), value(u, n - 2))

    return Rule(value, first, second)
