"""Arithmetic of truncated power series whose coefficients are arrays.

A series is an array of shape (L, *shape): coefficient k of s**k first. A constant has L = 1. The recurrences
are those of Griewank & Walther, "Evaluating Derivatives" (2nd ed., 2008), ch. 13, and Neidinger, SIAM Review
52 (2010) 545-563: each function solves an equation with its own derivative, which gives coefficient k from
those below it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from continuation.arrays import Array

Rule: TypeAlias = Callable[[Array], Array]
"""A function of one series."""


class JetDomainError(ArithmeticError):
    """A function was asked for its series at a point where it has none: sqrt(0), log(0), abs(0), 1/0."""


def demand(fine: Any, operation: str, need: str) -> None:
    """Raise JetDomainError, naming the operation, unless every entry is fine."""
    if not np.all(fine):
        raise JetDomainError(f"{operation} has no Taylor series here: {need}")


def extended(a: Array, length: int) -> Array:
    """The series `a`, a constant filled up with zeros to `length` coefficients."""
    if len(a) == length:
        return a
    out = np.zeros((length, *a.shape[1:]))
    out[0] = a[0]
    return out


# --- products and quotients -------------------------------------------------------------------------------


def multiply(a: Array, b: Array) -> Array:
    """Cauchy product of series of one length, as one contraction with a Toeplitz view of the second factor."""
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


def convolve(product: Callable[[Array, Array], Array], a: Array, b: Array) -> Array:
    """The series of a bilinear `product` that broadcasts over a leading axis (matmul, einsum)."""
    if len(a) == 1 or len(b) == 1:
        return product(a, b)
    if product is np.multiply:
        return multiply(a, b)
    out = product(a[:1], b)
    for j in range(1, len(b)):
        out[j:] += product(a[j : j + 1], b[:-j])
    return out


def divide(a: Array, b: Array) -> Array:
    """Quotient of two series; b[0] must not vanish."""
    demand(b[0] != 0, "numpy.divide", "the divisor's leading coefficient is 0")
    if len(b) == 1:
        return a / b
    a = extended(a, len(b))
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    out[0] = a[0] / b[0]
    for k in range(1, len(b)):
        out[k] = (a[k] - _tail(b, out, k)) / b[0]
    return out


def _tail(p: Array, q: Array, k: int) -> Array:
    """sum_{j=1..k} p_j q_{k-j}."""
    return np.asarray(np.einsum("j...,j...->...", p[1 : k + 1], q[k - 1 :: -1]))


# --- helpers of the recurrences ---------------------------------------------------------------------------


def _orders(u: Array) -> Array:
    return np.arange(float(len(u))).reshape(-1, *(1,) * (u.ndim - 1))


def _weighted(u: Array) -> Array:
    """The coefficients k u_k, of s u'(s)."""
    return _orders(u) * u


def _integral(weighted: Array, constant: Array) -> Array:
    """The series v with s v'(s) = `weighted` and v(0) = `constant`."""
    out = weighted / np.maximum(_orders(weighted), 1)
    out[0] = constant
    return out


def _shifted(u: Array, constant: float) -> Array:
    """The series u + constant."""
    out = u.copy()
    out[0] += constant
    return out


# --- elementary functions ---------------------------------------------------------------------------------


def exp(u: Array) -> Array:
    """Solves v' = v u'."""
    du, out = _weighted(u), np.empty_like(u)
    out[0] = np.exp(u[0])
    for k in range(1, len(u)):
        out[k] = _tail(du, out, k) / k
    return out


def expm1(u: Array) -> Array:
    """exp(u) - 1, its constant without cancellation."""
    out = exp(u)
    out[0] = np.expm1(u[0])
    return out


def exp2(u: Array) -> Array:
    """2**u."""
    return exp(u * np.log(2))


def log(u: Array) -> Array:
    """Solves v' = u' / u."""
    demand(~(u[0] <= 0), "numpy.log", "its argument's leading coefficient must be positive")
    return _integral(divide(_weighted(u), u), np.log(u[0]))


def log1p(u: Array) -> Array:
    """log(1 + u), its constant without cancellation."""
    demand(~(u[0] <= -1), "numpy.log1p", "its argument's leading coefficient must be above -1")
    return _integral(divide(_weighted(u), _shifted(u, 1)), np.log1p(u[0]))


def log2(u: Array) -> Array:
    """log(u) / log(2)."""
    return log(u) / float(np.log(2))


def log10(u: Array) -> Array:
    """log(u) / log(10)."""
    return log(u) / float(np.log(10))


def _sine_and_cosine(u: Array, sign: int) -> tuple[Array, Array]:
    """Circular (sign -1) or hyperbolic (+1): v' = w u', w' = sign v u'."""
    du, v, w = _weighted(u), np.empty_like(u), np.empty_like(u)
    v[0], w[0] = (np.sin(u[0]), np.cos(u[0])) if sign < 0 else (np.sinh(u[0]), np.cosh(u[0]))
    for k in range(1, len(u)):
        v[k] = _tail(du, w, k) / k
        w[k] = sign * _tail(du, v, k) / k
    return v, w


def sin(u: Array) -> Array:
    """Coupled with cos."""
    return _sine_and_cosine(u, -1)[0]


def cos(u: Array) -> Array:
    """Coupled with sin."""
    return _sine_and_cosine(u, -1)[1]


def sinh(u: Array) -> Array:
    """Coupled with cosh."""
    return _sine_and_cosine(u, 1)[0]


def cosh(u: Array) -> Array:
    """Coupled with sinh."""
    return _sine_and_cosine(u, 1)[1]


def _tangent(u: Array, v0: Array, w0: Array, sign: int) -> Array:
    """Solves v' = w u' with w = 1 + sign v**2; tan for sign +1, tanh for -1."""
    du, v, w = _weighted(u), np.empty_like(u), np.empty_like(u)
    v[0], w[0] = v0, w0
    for k in range(1, len(u)):
        v[k] = _tail(du, w, k) / k
        w[k] = sign * np.einsum("j...,j...->...", v[: k + 1], v[k::-1])
    return v


def tan(u: Array) -> Array:
    """Solves v' = (1 + v**2) u'."""
    return _tangent(u, np.tan(u[0]), 1 / np.cos(u[0]) ** 2, 1)


def tanh(u: Array) -> Array:
    """Solves v' = (1 - v**2) u'."""
    return _tangent(u, np.tanh(u[0]), 1 / np.cosh(u[0]) ** 2, -1)


def _product_root(a: Array, b: Array) -> Array:
    """sqrt(a b): the factors of 1 - u**2 are kept apart, so that nothing cancels near its zeros."""
    return sqrt(multiply(a, b))


def arcsin(u: Array) -> Array:
    """Solves v' = u' / sqrt(1 - u**2)."""
    demand(~(abs(u[0]) >= 1), "numpy.arcsin", "its argument's leading coefficient must lie inside (-1, 1)")
    return _integral(divide(_weighted(u), _product_root(_shifted(-u, 1), _shifted(u, 1))), np.arcsin(u[0]))


def arccos(u: Array) -> Array:
    """pi/2 - arcsin(u)."""
    demand(~(abs(u[0]) >= 1), "numpy.arccos", "its argument's leading coefficient must lie inside (-1, 1)")
    out = -arcsin(u)
    out[0] = np.arccos(u[0])
    return out


def arctan(u: Array) -> Array:
    """Solves v' = u' / (1 + u**2)."""
    return _integral(divide(_weighted(u), _shifted(multiply(u, u), 1)), np.arctan(u[0]))


def arcsinh(u: Array) -> Array:
    """Solves v' = u' / sqrt(1 + u**2)."""
    return _integral(divide(_weighted(u), sqrt(_shifted(multiply(u, u), 1))), np.arcsinh(u[0]))


def arccosh(u: Array) -> Array:
    """Solves v' = u' / sqrt(u**2 - 1)."""
    demand(~(u[0] <= 1), "numpy.arccosh", "its argument's leading coefficient must be above 1")
    return _integral(divide(_weighted(u), _product_root(_shifted(u, -1), _shifted(u, 1))), np.arccosh(u[0]))


def arctanh(u: Array) -> Array:
    """Solves v' = u' / (1 - u**2)."""
    demand(~(abs(u[0]) >= 1), "numpy.arctanh", "its argument's leading coefficient must lie inside (-1, 1)")
    return _integral(divide(_weighted(u), multiply(_shifted(-u, 1), _shifted(u, 1))), np.arctanh(u[0]))


# --- powers and roots -------------------------------------------------------------------------------------


def sqrt(u: Array) -> Array:
    """u**(1/2)."""
    demand(~(u[0] <= 0), "numpy.sqrt", "its argument's leading coefficient must be positive")
    return _power(u, 0.5, np.sqrt(u[0]))


def cbrt(u: Array) -> Array:
    """u**(1/3), for negative u too."""
    demand(u[0] != 0, "numpy.cbrt", "its argument's leading coefficient is 0")
    return _power(u, 1 / 3, np.cbrt(u[0]))


def absolute(u: Array) -> Array:
    """The branch of +-u that is positive."""
    demand(u[0] != 0, "numpy.absolute", "its argument's leading coefficient is 0")
    return np.asarray(np.sign(u[0]) * u)


def square(u: Array) -> Array:
    """u**2."""
    return multiply(u, u)


def reciprocal(u: Array) -> Array:
    """1 / u."""
    demand(u[0] != 0, "numpy.reciprocal", "its argument's leading coefficient is 0")
    return divide(np.ones((1,) * u.ndim), u)


def power(u: Array, exponent: Array) -> Array:
    """u**exponent, entry by entry; integer exponents allow a leading coefficient <= 0, negative ones no 0."""
    exponent = np.broadcast_to(exponent, np.broadcast_shapes(u.shape[1:], exponent.shape))
    values = np.unique(exponent)
    whole = values[values == np.trunc(values)]
    if len(values) == 1:
        return _whole_power(u, int(values[0])) if len(whole) else _real_power(u, exponent)
    u = np.broadcast_to(u, (len(u), *exponent.shape))
    out = np.empty_like(u)
    for value in whole:
        entries = exponent == value
        out[:, entries] = _whole_power(u[:, entries], int(value))
    entries = ~np.isin(exponent, whole)
    out[:, entries] = _real_power(u[:, entries], exponent[entries])
    return out


def _whole_power(u: Array, n: int) -> Array:
    """By repeated squaring: exact for polynomials, with no condition on the leading coefficient."""
    if n < 0:
        demand(u[0] != 0, "numpy.power", "a negative power of a leading coefficient 0")
        return reciprocal(_whole_power(u, -n))
    if n == 0:
        return extended(np.ones((1, *u.shape[1:])), len(u))
    if n == 1:
        return u.copy()
    half = _whole_power(u, n // 2)
    return multiply(multiply(half, half), u) if n % 2 else multiply(half, half)


def _real_power(u: Array, r: Array) -> Array:
    demand(~(u[0] <= 0), "numpy.power", "a fractional power needs a positive leading coefficient")
    return _power(u, r, u[0] ** r)


def _power(u: Array, r: Any, v0: Array) -> Array:
    """Solves u v' = r v u'."""
    out = np.empty((len(u), *v0.shape))
    out[0] = v0
    orders = np.arange(1.0, len(u)).reshape(-1, *(1,) * v0.ndim)
    for k in range(1, len(u)):
        weights = (r + 1) * (orders[:k] / k) - 1
        out[k] = np.einsum("j...,j...->...", weights * u[1 : k + 1], out[k - 1 :: -1]) / u[0]
    return out
