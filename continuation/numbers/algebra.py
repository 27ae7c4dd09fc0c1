"""Truncated algebras over numbers or intervals: c_0 + d with a nilpotent d.

Linear operations, along the leading axis, are common. Algebras differ in `degrees`, each coefficient's power of d, in
`product`, by a bilinear product of coefficients, and in `expansion`, f(c_0 + d) = sum_k f_k d^k, with f's Taylor
coefficients f_k at c_0.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from attrs import frozen

from continuation.numbers import series
from continuation.numbers.ends import Ends, moved, thin

Coefficients: TypeAlias = Any
"""Coefficients, shape (L, ...); L = 1 is a constant."""


@frozen
class TaylorAlgebra:
    """Truncated series sum_k c_k s**k."""

    def degrees(self, length: int) -> list[int]:
        """0, 1, ..., length - 1."""
        return list(range(length))

    def product(self, product: Callable[[Any, Any], Any], a: Coefficients, b: Coefficients) -> Coefficients:
        """The Cauchy product."""
        if product is operator.mul and not isinstance(a, Ends):
            return series.multiply(a, b)
        out = product(a[:1], b)
        for j in range(1, len(b)):
            out[j:] += product(a[j : j + 1], b[:-j])
        return out

    def expansion(self, f: list[Any], a: Coefficients) -> Coefficients:
        """f_0 + f_1 d + f_2 d^2 for d, `a` without its constant: this algebra has no third order."""
        d, less = a[1:], a[1:-1]
        out = f[1] * d
        if len(less):
            out[1:] += f[2] * product(self, operator.mul, less, less)
        return joined(f[0][None], out)


@frozen
class GradientAlgebra:
    """First derivatives in many directions: c_0 + sum_i c_i e_i with e_i e_j = 0."""

    def degrees(self, length: int) -> list[int]:
        """0, 1, 1, ..."""
        return [0] + [1] * (length - 1)

    def product(self, product: Callable[[Any, Any], Any], a: Coefficients, b: Coefficients) -> Coefficients:
        """The product rule."""
        out = product(a[:1], b)
        out[1:] += product(a[1:], b[:1])
        return out

    def expansion(self, f: list[Any], a: Coefficients) -> Coefficients:
        """The chain rule."""
        out = f[1] * a
        out[:1] = f[0][None]
        return out


@frozen
class Beside:
    """x + y s with s^2 = 0, x and y of the inner algebra; the coefficients of x come first."""

    inner: TaylorAlgebra | GradientAlgebra | Beside

    def degrees(self, length: int) -> list[int]:
        """Degrees of x, then of y, one higher."""
        inner = self.inner.degrees(length // 2)
        return [*inner, *(degree + 1 for degree in inner)]

    def product(self, multiply: Callable[[Any, Any], Any], a: Coefficients, b: Coefficients) -> Coefficients:
        """The product rule."""
        (x, y), (v, w) = _halves(a), _halves(b)
        slope = product(self.inner, multiply, x, w) + product(self.inner, multiply, y, v)
        return joined(product(self.inner, multiply, x, v), slope)

    def expansion(self, f: list[Any], a: Coefficients) -> Coefficients:
        """f(x) and f'(x) y."""
        x, y = _halves(a)
        slopes = [f[1], *(float(k) * f[k] for k in range(2, len(f)))]
        return joined(_at(self.inner, f, x), product(self.inner, operator.mul, _at(self.inner, slopes, x), y))


Algebra: TypeAlias = TaylorAlgebra | GradientAlgebra | Beside


def _halves(a: Coefficients) -> tuple[Coefficients, Coefficients]:
    return a[: len(a) // 2], a[len(a) // 2 :]


def _at(algebra: Algebra, f: list[Any], a: Coefficients) -> Coefficients:
    return f[0][None] if len(a) == 1 else algebra.expansion(f, a)


def joined(*parts: Coefficients) -> Coefficients:
    """Coefficients, one after another."""
    return moved(lambda *arrays: np.concatenate(arrays), *parts)


def lengthened(a: Coefficients, length: int) -> Coefficients:
    """`a` with zero coefficients appended."""
    return a if len(a) == length else moved(lambda x: series.padded(x, length), a)


def product(algebra: Algebra, multiply: Callable[[Any, Any], Any], a: Coefficients, b: Coefficients) -> Coefficients:
    """A bilinear product; factors may be constant."""
    return multiply(a, b) if len(a) == 1 or len(b) == 1 else algebra.product(multiply, a, b)


def quotient(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
    """The quotient, by iterating q = (a - d q) / b_0 with b = b_0 + d."""
    if not isinstance(b, Ends):
        series.demand(b[0] != 0, "numpy.divide", "the divisor's leading coefficient is 0")
    if len(b) == 1:
        return a / b
    if isinstance(algebra, TaylorAlgebra) and not isinstance(b, Ends):
        return series.divide(a, b)
    d, q = b.copy(), a[:1] / b[:1]
    d[:1] = 0.0 * d[:1]
    for _ in range(algebra.degrees(len(b))[-1]):
        q = (lengthened(a, len(b)) - product(algebra, operator.mul, d, q)) / b[:1]
    return q


def compose(algebra: Algebra, rule: series.SeriesRule, a: Coefficients) -> Coefficients:
    """Apply a function of one argument, by its rule."""
    order = 0 if len(a) == 1 else algebra.degrees(len(a))[-1]
    if isinstance(a, Ends):
        f = rule([a[0], 1.0, *[0.0] * (order - 1)][: order + 1])
        f = [c if isinstance(c, Ends) else thin(np.full(a.shape[1:], c)) for c in f]
        told = ~(np.isnan(f[0].lo) | np.isnan(f[0].hi))
        return _at(algebra, f if told.all() else [f[0], *(c.where(told) for c in f[1:])], a)
    if isinstance(algebra, TaylorAlgebra):
        return rule(a)
    line = np.zeros((order + 1, *a.shape[1:]))
    line[0], line[1:2] = a[0], 1.0
    return _at(algebra, rule(line), a)


TAYLOR = TaylorAlgebra()
GRADIENT = GradientAlgebra()
