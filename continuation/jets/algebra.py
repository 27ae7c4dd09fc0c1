"""The algebras that a jet can live in: one direction to high order, many to first order, or many beside one direction.

All keep coefficients along the leading axis, so everything linear is shared; they differ in products,
quotients and compositions only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.jets import series


class Algebra(Protocol):
    """What is done to coefficient arrays (L, *shape); L = 1 is a constant."""

    def product(self, product: Callable[[Array, Array], Array], a: Array, b: Array) -> Array:
        """A bilinear product, which broadcasts over the leading axis."""
        ...

    def quotient(self, a: Array, b: Array) -> Array:
        """The quotient a / b, entry by entry."""
        ...

    def compose(self, rule: series.Rule, a: Array) -> Array:
        """A function of one series, given by its rule on truncated Taylor series."""
        ...


@frozen
class Taylor:
    """sum_k c_k s**k, truncated: the coefficients of one direction."""

    def product(self, product: Callable[[Array, Array], Array], a: Array, b: Array) -> Array:
        """The Cauchy product."""
        return series.convolve(product, a, b)

    def quotient(self, a: Array, b: Array) -> Array:
        """The series of a / b."""
        return series.divide(a, b)

    def compose(self, rule: series.Rule, a: Array) -> Array:
        """The rule itself."""
        return rule(a)


@frozen
class Gradient:
    """c_0 + sum_i c_i e_i with e_i e_j = 0: first derivatives in many directions at once."""

    def product(self, product: Callable[[Array, Array], Array], a: Array, b: Array) -> Array:
        """The product rule."""
        if len(a) == 1 or len(b) == 1:
            return product(a, b)
        out = product(a[:1], b)
        out[1:] += product(a[1:], b[:1])
        return out

    def quotient(self, a: Array, b: Array) -> Array:
        """The quotient rule."""
        value = series.divide(a[:1], b[:1])
        if len(b) == 1:
            return np.asarray(a / b)
        slopes = -value * b[1:]
        if len(a) > 1:
            slopes += a[1:]
        return np.concatenate([value, slopes / b[:1]])

    def compose(self, rule: series.Rule, a: Array) -> Array:
        """The chain rule, with the derivative from the rule's own series at order 1."""
        value, slope = rule(np.stack([a[0], np.ones_like(a[0])]))
        return np.concatenate([value[None], slope * a[1:]])


@frozen
class Mixed:
    """The gradient's algebra over the dual numbers, s^2 = 0: derivatives along one direction of those in many.

    Coefficients: 1, the e_i, s, and the s e_i.
    """

    def product(self, product: Callable[[Array, Array], Array], a: Array, b: Array) -> Array:
        """The product rule, twice."""
        if len(a) == 1 or len(b) == 1:
            return product(a, b)
        half = len(a) // 2
        value = GRADIENT.product(product, a[:half], b[:half])
        slope = GRADIENT.product(product, a[:half], b[half:]) + GRADIENT.product(product, a[half:], b[:half])
        return np.concatenate([value, slope])

    def quotient(self, a: Array, b: Array) -> Array:
        """The quotient as a product."""
        series.demand(b[0] != 0, "numpy.divide", "the divisor's leading coefficient is 0")
        inverse = self.compose(series.reciprocal, b) if len(b) > 1 else 1.0 / b
        return self.product(np.multiply, a, inverse)

    def compose(self, rule: series.Rule, a: Array) -> Array:
        """The chain rule, with two derivatives from the rule's own series at order 2."""
        value, slope, half_bend = rule(np.stack([a[0], np.ones_like(a[0]), np.zeros_like(a[0])]))
        out = slope * a
        half = len(a) // 2
        out[0] = value
        out[half + 1 :] += 2.0 * half_bend * a[half] * a[1:half]
        return np.asarray(out)


TAYLOR = Taylor()
GRADIENT = Gradient()
MIXED = Mixed()
