"""Truncated power series of elementary functions, by recurrences from their differential equations.

A series is an array, (L, *shape), s**0 first; a constant has L = 1. Over intervals it is a list of intervals and exact
numbers. Recurrences: Griewank & Walther, "Evaluating Derivatives" (2nd ed., 2008), ch. 13; Neidinger, SIAM Review 52
(2010) 545-563.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import comb
from typing import Any, TypeAlias

import numpy as np

from continuation.arrays import Array
from continuation.numbers.ends import Ends, as_ends, thin
from continuation.numbers.ranges import LN2, LN10, RANGES, near
from continuation.numbers.ranges import power as power_range

PowerSeries: TypeAlias = Any

SeriesRule: TypeAlias = Callable[[PowerSeries], PowerSeries]


class JetDomainError(ArithmeticError):
    """A function has no series at a point, as sqrt(0)."""


def demand(fine: Any, operation: str, need: str) -> None:
    """Raise JetDomainError unless `fine` holds everywhere."""
    if not np.all(fine):
        raise JetDomainError(f"{operation} has no Taylor series here: {need}")


def _demand(u: PowerSeries, fine: Callable[[Array], Any], operation: str, need: str) -> None:
    if not isinstance(u, list):
        demand(fine(u[0]), operation, f"its argument's leading coefficient must {need}")


def padded(u: Array, length: int) -> Array:
    """`u` with zero coefficients appended."""
    out = np.zeros((length, *u.shape[1:]), u.dtype)
    out[: len(u)] = u
    return out


def of(function: np.ufunc, x: Any) -> Any:
    """Values of a function, or their range."""
    return RANGES[function](x) if isinstance(x, Ends) else function(x)


# Products and quotients


def multiply(a: PowerSeries, b: PowerSeries) -> PowerSeries:
    """Cauchy product, by a Toeplitz view of b."""
    if isinstance(a, list):
        return [_dot(a[: k + 1], b[k::-1]) for k in range(len(a))]
    length = len(b)
    if length == 2:
        out: Array = a[:1] * b
        out[1:] += a[1:] * b[:1]
        return out
    padded = np.zeros((2 * length - 1, *b.shape[1:]))
    padded[length - 1 :] = b
    stride, *strides = padded.strides
    toeplitz: Array = np.ndarray(
        (length, length, *b.shape[1:]), float, padded, (length - 1) * stride, (stride, -stride, *strides)
    )
    return np.asarray(np.einsum("j...,kj...->k...", a, toeplitz))


def divide(a: PowerSeries, b: PowerSeries) -> PowerSeries:
    """Quotient; b[0] must not vanish."""
    if not isinstance(b, list):
        demand(b[0] != 0, "numpy.divide", "the divisor's leading coefficient is 0")
        if len(b) == 1:
            return a / b
        a = padded(a, len(b))
    out = _room(a, b)
    out[0] = _over(a[0], b[0])
    for k in range(1, len(b)):
        out[k] = _over(a[k] - _tail(b, out, k), b[0])
    return out


def _dot(p: PowerSeries, q: PowerSeries) -> Any:
    if not isinstance(p, list):
        return np.einsum("j...,j...->...", p, q)
    total: Any = 0.0
    for a, b in zip(p, q):
        if a != 0.0 and b != 0.0:  # an interval equals no number
            term = b if a == 1.0 else a if b == 1.0 else a * b
            total = term if total == 0.0 else total + term
    return total


def _tail(p: PowerSeries, q: PowerSeries, k: int) -> Any:
    return _dot(p[1 : k + 1], q[k - 1 :: -1])


def _over(a: Any, b: Any) -> Any:
    """Quotient; halving an interval is a cheaper product."""
    if type(a) is float and a == 0.0:
        return a
    return a if type(b) is int and b == 1 else a * 0.5 if type(b) is int and b == 2 else a / b


# Helpers


def _room(*series: PowerSeries) -> PowerSeries:
    if isinstance(series[0], list):
        return [0.0] * len(series[0])
    if len(series) == 1:
        return np.empty_like(series[0])
    return np.empty(np.broadcast_shapes(*(u.shape for u in series)), np.result_type(*series))


def _orders(u: Array) -> Array:
    return np.arange(float(len(u))).reshape(-1, *(1,) * (u.ndim - 1))


def _weighted(u: PowerSeries) -> PowerSeries:
    return [0.0, *(k * x for k, x in enumerate(u[1:], 1))] if isinstance(u, list) else _orders(u) * u


def _scaled(u: PowerSeries, factor: Any) -> PowerSeries:
    if isinstance(u, list):
        return [_dot([factor], [x]) for x in u]
    return u if type(factor) is float and factor == 1.0 else factor * u


def _known(u: PowerSeries, constant: Ends) -> Any:
    return constant if isinstance(u, list) else float(constant.middle())


def _shifted(u: PowerSeries, constant: float, sign: int = 1) -> PowerSeries:
    if isinstance(u, list):
        return [constant + u[0] if sign > 0 else constant - u[0], *(sign * x for x in u[1:])]
    out = sign * u
    out[0] += constant
    return out


# Elementary functions


def _exponential(u: PowerSeries, function: np.ufunc, rate: Any = 1.0, first: np.ufunc | None = None) -> PowerSeries:
    """Solve v' = rate v u'; `first` replaces v_0."""
    du, out = _scaled(_weighted(u), rate), _room(u)
    out[0] = of(function, u[0])
    for k in range(1, len(u)):
        out[k] = _over(_tail(du, out, k), k)
    out[0] = of(first, u[0]) if first else out[0]
    return out


def _pair(u: PowerSeries, sine: np.ufunc, cosine: np.ufunc, sign: int) -> tuple[PowerSeries, PowerSeries]:
    """Solve v' = w u', w' = sign v u': circular (-1) or hyperbolic (+1)."""
    du, v, w = _weighted(u), _room(u), _room(u)
    v[0], w[0] = of(sine, u[0]), of(cosine, u[0])
    for k in range(1, len(u)):
        v[k] = _over(_tail(du, w, k), k)
        slope = _over(_tail(du, v, k), k)
        w[k] = slope if sign > 0 else -slope
    return v, w


def _tangent(u: PowerSeries, function: np.ufunc, cosine: np.ufunc, sign: int) -> PowerSeries:
    """Solve v' = w u', w = 1 + sign v**2: tan (+1) or tanh (-1)."""
    du, v, w = _weighted(u), _room(u), _room(u)
    v[0] = of(function, u[0])
    if isinstance(u, list):
        w[0] = 1.0 + v[0] * v[0] if sign > 0 else (1.0 - v[0]) * (1.0 + v[0])
    else:
        w[0] = 1 / cosine(u[0]) ** 2
    for k in range(1, len(u)):
        v[k] = _over(_tail(du, w, k), k)
        square = _dot(v[: k + 1], v[k::-1])
        w[k] = square if sign > 0 else -square
    return v


def _circle(u: PowerSeries, sign: int) -> PowerSeries:
    """The value sign (1 - u**2), from factors, so accurate near its zeros."""
    return multiply(_shifted(u, sign, -sign), _shifted(u, 1))


Inverse: TypeAlias = tuple[Callable[[PowerSeries], PowerSeries], Callable[[Array], Any], str]

BY_SLOPE: dict[np.ufunc, Inverse] = {
    np.log: (lambda u: u, lambda x: x <= 0, "be positive"),
    np.log1p: (lambda u: _shifted(u, 1), lambda x: x <= -1, "be above -1"),
    np.log2: (lambda u: _scaled(u, _known(u, LN2)), lambda x: x <= 0, "be positive"),
    np.log10: (lambda u: _scaled(u, _known(u, LN10)), lambda x: x <= 0, "be positive"),
    np.arcsin: (lambda u: sqrt(_circle(u, 1)), lambda x: abs(x) >= 1, "lie inside (-1, 1)"),
    np.arccos: (lambda u: _scaled(sqrt(_circle(u, 1)), -1.0), lambda x: abs(x) >= 1, "lie inside (-1, 1)"),
    np.arctan: (lambda u: _shifted(square(u), 1), lambda x: False, ""),
    np.arcsinh: (lambda u: sqrt(_shifted(square(u), 1)), lambda x: False, ""),
    np.arccosh: (lambda u: sqrt(_circle(u, -1)), lambda x: x <= 1, "be above 1"),
    np.arctanh: (lambda u: _circle(u, 1), lambda x: abs(x) >= 1, "lie inside (-1, 1)"),
}
"""Functions with derivative 1 / D(u): D, the excluded arguments, and the requirement in words."""


def _by_slope(function: np.ufunc, u: PowerSeries) -> PowerSeries:
    """Solve v' = u' / D(u)."""
    divisor, outside, need = BY_SLOPE[function]
    _demand(u, lambda x: ~np.asarray(outside(x)), f"numpy.{function.__name__}", need)
    slope = divide(_weighted(u), divisor(u))
    if isinstance(u, list):
        return [of(function, u[0]), *(_over(x, k) for k, x in enumerate(slope[1:], 1))]
    out = slope / np.maximum(_orders(u), 1)
    out[0] = function(u[0])
    return np.asarray(out)


# Powers and roots


def sqrt(u: PowerSeries) -> PowerSeries:
    """u**(1/2)."""
    _demand(u, lambda x: ~(x <= 0), "numpy.sqrt", "be positive")
    out = _room(u)
    out[0] = of(np.sqrt, u[0])
    twice = 2.0 * out[0]
    for k in range(1, len(u)):  # v v = u: v_0 / u_0 has a wider range than 1 / v_0
        out[k] = _over(u[k] - _dot(out[1:k], out[k - 1 : 0 : -1]), twice)
    return out


def cbrt(u: PowerSeries) -> PowerSeries:
    """u**(1/3), also for u < 0."""
    _demand(u, lambda x: x != 0, "numpy.cbrt", "not be 0")
    return _power(u, as_ends(1.0) / 3.0 if isinstance(u, list) else 1 / 3, of(np.cbrt, u[0]))


def absolute(u: PowerSeries) -> PowerSeries:
    """|u|; an interval around zero has both slopes, then nan."""
    _demand(u, lambda x: x != 0, "numpy.absolute", "not be 0")
    if not isinstance(u, list):
        return np.asarray(np.sign(u[0]) * u)
    x = u[0]
    decided = (x.lo > 0.0) | (x.hi < 0.0)
    sign = Ends(np.where(x.lo > 0.0, 1.0, -1.0), np.where(x.hi < 0.0, -1.0, 1.0))
    return [of(np.absolute, x), sign, *(thin(np.where(decided, 0.0, np.nan)) for _ in u[2:])][: len(u)]


def square(u: PowerSeries) -> PowerSeries:
    """u**2."""
    return power(u, 2) if isinstance(u, list) else multiply(u, u)


def reciprocal(u: PowerSeries) -> PowerSeries:
    """1 / u."""
    _demand(u, lambda x: x != 0, "numpy.reciprocal", "not be 0")
    return power(u, -1) if isinstance(u, list) else divide(np.ones((1,) * u.ndim), u)


def power(u: PowerSeries, r: float) -> PowerSeries:
    """u**r; integers allow a leading coefficient <= 0, negative ones not 0."""
    if r != int(r):
        _demand(u, lambda x: ~(x <= 0), "numpy.power", "be positive for a fractional power")
        return _power(u, r, power_range(u[0], r) if isinstance(u, list) else u[0] ** r)
    n = int(r)
    if isinstance(u, list):  # u = x + s
        counts = [comb(n, k) if n >= 0 else (-1) ** k * comb(k - n - 1, k) for k in range(len(u))]
        factors = [float(count) if abs(count) <= 2**53 else near(float(count)) for count in counts]
        return [_dot([factor], [u[0] ** (n - k)]) for k, factor in enumerate(factors)]
    return _whole_power(u, n)


def _whole_power(u: Array, n: int) -> Array:
    """Repeated squaring, exact for polynomials."""
    if n < 0:
        demand(u[0] != 0, "numpy.power", "a negative power of a leading coefficient 0")
        return np.asarray(reciprocal(_whole_power(u, -n)))
    if n == 0:
        return padded(np.ones((1, *u.shape[1:])), len(u))
    if n == 1:
        return u.copy()
    half = _whole_power(u, n // 2)
    return np.asarray(multiply(multiply(half, half), u) if n % 2 else multiply(half, half))


def _power(u: PowerSeries, r: Any, v0: Any) -> PowerSeries:
    """Solve u v' = r v u'."""
    if isinstance(u, list):  # u = x + s
        out: PowerSeries = [v0]
        for k in range(1, len(u)):
            out.append(out[k - 1] * (as_ends(r) - (k - 1.0)) / (float(k) * u[0]))
        return out
    out = np.empty((len(u), *v0.shape), v0.dtype)
    out[0] = v0
    orders = np.arange(1.0, len(u)).reshape(-1, *(1,) * v0.ndim)
    for k in range(1, len(u)):
        weights = (r + 1) * (orders[:k] / k) - 1
        out[k] = np.einsum("j...,j...->...", weights * u[1 : k + 1], out[k - 1 :: -1]) / u[0]
    return out


ELEMENTARY: dict[np.ufunc, SeriesRule] = {
    np.absolute: absolute,
    np.square: square,
    np.sqrt: sqrt,
    np.cbrt: cbrt,
    np.reciprocal: reciprocal,
    np.exp: lambda u: _exponential(u, np.exp),
    np.exp2: lambda u: _exponential(u, np.exp2, _known(u, LN2)),
    np.expm1: lambda u: _exponential(u, np.exp, first=np.expm1),
    np.sin: lambda u: _pair(u, np.sin, np.cos, -1)[0],
    np.cos: lambda u: _pair(u, np.sin, np.cos, -1)[1],
    np.sinh: lambda u: _pair(u, np.sinh, np.cosh, 1)[0],
    np.cosh: lambda u: _pair(u, np.sinh, np.cosh, 1)[1],
    np.tan: lambda u: _tangent(u, np.tan, np.cos, 1),
    np.tanh: lambda u: _tangent(u, np.tanh, np.cosh, -1),
    **{function: partial(_by_slope, function) for function in BY_SLOPE},
}
"""Rules by ufunc."""
