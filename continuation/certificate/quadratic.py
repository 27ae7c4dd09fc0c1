"""Krawczyk's test for homotopies that are quadratic in all unknowns and the parameter: exact in the tube's width.

H(p + d) = H(p) + H'(p) d + Q(d, d), so that the derivative needs no interval arithmetic, only bounds of rounding; and
along a cubic H is a polynomial of degree 6, H' one of degree 3. The preconditioner follows the path,
Y(s) = (I - x E + x^2 C) Y_0 with x = s - middle, its inverse's series: terms of third order in x are left. No tensor
of third order is formed.
"""

from __future__ import annotations

from functools import cached_property
from math import comb
from typing import ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.certificate.cells import Slabs, expansion
from continuation.certificate.engine import Judged, applied, up_by
from continuation.certificate.form import ROUNDED, Affine, Quadratic
from continuation.certificate.inverse import inverted, times
from continuation.certificate.krawczyk import Several
from continuation.intervals.ends import EPS, Ends, accumulated, bilinear, thin

ENTRIES = 1_000_000
"""Numbers of one array of matrices at a time: 8 MB."""


def _apply(part: Affine, q: Ends) -> Ends:
    """The part along a cubic, shape (slabs, 4, N) for coefficients of shape (slabs, 4, N + 1)."""
    matrix = Ends(part.matrix - part.error, part.matrix + part.error) if part.sizes is not None else thin(part.matrix)
    image = bilinear(lambda a, b: np.matmul(b, a.T), matrix, q)
    value = image[:, 0] + part.constant_ends
    image.lo[:, 0], image.hi[:, 0] = value.lo, value.hi
    return image


@frozen(eq=False)
class ByProducts:
    """The engine of quadratic homotopies.

    Attributes
    ----------
    form : Quadratic
    """

    form: Quadratic
    exact: ClassVar[bool] = True
    order: ClassVar[int] = 3
    most: ClassVar[int] = 4
    fine: ClassVar[int] = 1

    def judge(self, slabs: Slabs, radius: Array) -> Judged:
        """As `continuation.certificate.krawczyk.Engine.judge`; valid for all radii."""
        m = radius.shape[1]
        size = max(1, ENTRIES // (m * m))
        places = np.array_split(np.arange(len(slabs)), -(-len(slabs) // size))
        with np.errstate(all="ignore"):
            return Several.of([(place, self._judge(slabs.take(place), radius[place])) for place in places])

    def _judge(self, slabs: Slabs, radius: Array) -> Polynomial:
        form, chart = self.form, slabs.cells.chart
        q = expansion(slabs).q
        cubic = Ends(np.stack([k.lo for k in q], axis=1), np.stack([k.hi for k in q], axis=1))
        alpha, beta, value = (_apply(part, cubic) for part in (form.first, form.second, form.plain))
        derivative, H = Derivative.of(form, alpha, beta), _coefficients(value, alpha, beta)
        return Polynomial.of(derivative, chart, H, slabs.offset[:, None], radius)


_SUMS = np.array([[float(i + j == k) for i in range(4) for j in range(4)] for k in range(7)])
"""Which products of coefficients belong to which power."""


def _coefficients(value: Ends, alpha: Ends, beta: Ends) -> Ends:
    """Of H along the cubic: shape (slabs, N, 7)."""
    products = alpha[:, :, None] * beta[:, None, :]
    count, n = alpha.shape[0], alpha.shape[2]
    flat = Ends(*(x.reshape(count, 16, n) for x in (products.lo, products.hi)))
    total = bilinear(lambda a, b: np.matmul(b.transpose(0, 2, 1), a.T), thin(_SUMS), flat)
    lower, upper = (np.zeros((count, n, 7)) for _ in range(2))
    lower[..., :4], upper[..., :4] = value.lo.transpose(0, 2, 1), value.hi.transpose(0, 2, 1)
    return total + Ends(lower, upper)


def _raised(polynomial: Ends, power: int) -> Ends:
    """A polynomial of degree 6 times x, so many times, as one of degree 8."""
    out = tuple(np.zeros((*polynomial.lo.shape[:2], 9)) for _ in range(2))
    out[0][..., power : power + 7], out[1][..., power : power + 7] = polynomial.lo, polynomial.hi
    return Ends(*out)


PARTS = 8
"""Into so many parts a slab is cut for the range of H along the cubic: it all but vanishes at both ends of a cell, so
that the sum of its coefficients' sizes is several times as much."""


def _shifts() -> Array:
    """For polynomials of degree 8 on [-1, 1], their coefficients on each part; exact, (9, PARTS * 9)."""
    out = np.zeros((9, PARTS, 9))
    for part in range(PARTS):
        middle = (2 * part + 1) / PARTS - 1.0
        for k in range(9):
            out[k, part, : k + 1] = [comb(k, i) * middle ** (k - i) / PARTS**i for i in range(k + 1)]
    return out.reshape(9, -1)


_SHIFTS = _shifts()


def _misfit(coefficients: Ends, left: Array, E: Array, C: Array, offset: Array) -> Array:
    """|Y(s) H(p(s))|: the range of the polynomial (I - x E + x^2 C) Y_0 H, part by part."""
    if not offset.any():
        return up_by(bilinear(np.matmul, thin(left), coefficients[..., :1])[..., 0].magnitude(), 1)
    image = bilinear(np.matmul, thin(left), coefficients)
    by_E, by_C = (bilinear(np.matmul, thin(matrix), image) for matrix in (E, C))
    whole = _raised(image, 0) - _raised(by_E, 1) + _raised(by_C, 2)
    t = thin(offset[:, :, None])
    power, scaled = thin(np.ones_like(t.lo)), []
    for k in range(9):
        scaled.append(whole[..., k : k + 1] * power)
        power = power * t
    unit = Ends(*(np.concatenate(x, axis=-1) for x in ([u.lo for u in scaled], [u.hi for u in scaled])))
    parts = bilinear(np.matmul, unit, thin(_SHIFTS[None])).magnitude().reshape(*unit.lo.shape[:2], PARTS, 9)
    return up_by(parts.sum(axis=-1).max(axis=-1), 16)


@frozen(eq=False)
class Derivative:
    """H' along the cubic, a polynomial of degree 3: coefficient k is plain (k = 0) + alpha_k second + beta_k first.

    Attributes
    ----------
    form : Quadratic
    a, b : ndarray, shape (slabs, 4, N)
        About alpha and beta.
    ra, rb : ndarray
        How far those may be off.
    """

    form: Quadratic
    a: Array
    b: Array
    ra: Array
    rb: Array

    @classmethod
    def of(cls, form: Quadratic, alpha: Ends, beta: Ends) -> Derivative:
        """By middle and radius."""
        a, b = alpha.middle(), beta.middle()
        return cls(form, a, b, alpha.radius(a), beta.radius(b))

    def matrix(self, k: int) -> Array:
        """Coefficient k in floats, shape (slabs, N, N + 1)."""
        form, a, b = self.form, self.a[:, k, :, None], self.b[:, k, :, None]
        out: Array = a * form.second.matrix + b * form.first.matrix
        return out + form.plain.matrix if k == 0 else out

    def image(self, x: Array) -> tuple[Array, Array]:
        """Bounds of |exact| x, and of |exact - matrix| x, for all coefficients; shape (slabs, 4, N)."""
        form, count = self.form, 2 * x.shape[1]
        by_second, by_first = (np.matmul(x, part.size.T)[:, None] for part in (form.second, form.first))
        error = self.ra * by_second + self.rb * by_first
        size = np.abs(self.a) * by_second + np.abs(self.b) * by_first + error
        for part, factor in ((form.second, self.a), (form.first, self.b)):
            if part.sizes is not None:
                error = error + np.abs(factor) * np.matmul(x, part.error.T)[:, None]
        size[:, 0] += np.matmul(x, form.plain.size.T)
        error[:, 0] += np.matmul(x, form.plain.error.T)
        return up_by(size, count), up_by(error + 4.0 * EPS * size, count)

    def products(self, x: Array, radius: Array) -> Array:
        """A bound of |2 Q(d, x)| for |d| <= radius."""
        first, second = self.form.first.size.T, self.form.second.size.T
        crossed = np.matmul(radius, first) * np.matmul(x, second) + np.matmul(x, first) * np.matmul(radius, second)
        return up_by(crossed * (1.0 + ROUNDED) ** 2, 2 * x.shape[1])


@frozen(eq=False, slots=False)
class Polynomial:
    """The bounds as polynomials in the offset: what is left of I - Y(s) G'(p(s) + d), applied to vectors."""

    misfit: Array
    derivative: Derivative
    chart: Array
    Y: Array
    size_Y: Array
    rest: Array
    E: Array
    size_F: Array
    C: Array
    third: Array
    offset: Array

    @cached_property
    def size_E(self) -> Array:
        """|E|."""
        return np.abs(self.E)

    @cached_property
    def size_C(self) -> Array:
        """|C|."""
        return np.abs(self.C)

    @classmethod
    def of(cls, derivative: Derivative, chart: Array, H: Ends, offset: Array, radius: Array) -> Polynomial:
        """With the coefficients of H along the cubic."""
        G0 = np.concatenate([derivative.matrix(0), chart[:, None, :]], axis=1)
        Y, R = inverted(G0, *derivative.form.pivots, radius)
        left, size_Y = Y[:, :, :-1], np.abs(Y)
        if not offset.any():
            none = np.zeros_like(Y)
            misfit = _misfit(H, left, none, none, offset)
            return cls(misfit, derivative, chart, Y, size_Y, R, none, none, none, none, offset)
        E, F = (np.matmul(left, derivative.matrix(k)) for k in (1, 2))
        C = np.matmul(E, E) - F
        misfit = _misfit(H, left, E, C, offset)
        third = np.abs(np.matmul(E, F) - np.matmul(C, E) - np.matmul(left, derivative.matrix(3)))
        return cls(misfit, derivative, chart, Y, size_Y, R, E, np.abs(F), C, third, offset)

    @property
    def across(self) -> Ends:
        """Y(s) = (I - x E + x^2 C) Y_0."""
        return self._moved(thin(self.Y[:, :, -1]))

    def applied(self, v: Ends) -> Ends:
        """Y(s) = (I - x E + x^2 C) Y_0."""
        return self._moved(applied(self.Y, v))

    def _moved(self, image: Ends) -> Ends:
        by_E, by_C = (applied(matrix, image) for matrix in (self.E, self.C))
        t = self.offset
        return image + Ends(-t, t) * by_E + Ends(np.zeros_like(t), t * t * (1.0 + 4.0 * EPS)) * by_C

    def spread(self, x: Array, radius: Array) -> Array:
        """See `Judged.spread`.

        The terms are those of I - (I - x E + x^2 C) Y_0 (G_0 + x G_1 + x^2 G_2 + x^3 G_3), up to rounding
        Y_0 G_1 = E, Y_0 G_2 = F and C = E E - F, and of Y(s) 2 Q(d, .).
        """
        t, m = self.offset, x.shape[1]
        gamma = accumulated(m)
        left = self.size_Y[:, :, :-1]
        with np.errstate(all="ignore"):
            sizes, errors = self.derivative.image(x)
            vectors = np.stack([*sizes.transpose(1, 0, 2), *errors.transpose(1, 0, 2)], axis=-1)
            through = np.matmul(
                left, np.concatenate([vectors, self.derivative.products(x, radius)[..., None]], axis=-1)
            )
            size, error, quadratic = through[..., :4], through[..., 4:8], through[..., 8]
            along = up_by((np.abs(self.chart) * x).sum(axis=1, keepdims=True), m)
            # |I - Y_0 G_0| x, with the rounding of the product and the errors of G_0.
            base = times(self.rest, x) + gamma * (size[..., 0] + self.size_Y[:, :, -1] * along + x) + error[..., 0]
            if not t.any():
                return up_by(base + quadratic, 4 * m + 16)
            # |Y_0 G_k - E, F, H| x: rounding of the products.
            first, second, last = (gamma * size[..., k] + error[..., k] for k in (1, 2, 3))
            size_E, size_C = self.size_E, self.size_C
            by_F, by_H = times(self.size_F, x), size[..., 3] + error[..., 3]
            by_E = np.matmul(size_E, np.stack([x, base, first, by_F, second, by_H, quadratic], axis=-1))
            inner = [base, by_E[..., 0], first, by_F + second, by_H, quadratic]
            by_C = np.matmul(size_C, np.stack(inner, axis=-1))
            # |E E - F - C| x, and the same of the third power.
            rounding = gamma * (times(size_E, by_E[..., 0]) + by_F)
            more = gamma * (by_E[..., 3] + by_C[..., 1] + size[..., 3])
            powers = (
                base + quadratic,
                first + by_E[..., 1] + by_E[..., 6],
                second + by_E[..., 2] + rounding + by_C[..., 0] + by_C[..., 5],
                times(self.third, x) + 2.0 * more + last + by_E[..., 4] + by_C[..., 2],
                by_E[..., 5] + by_C[..., 3],
                by_C[..., 4],
            )
            total = sum((power * t**k for k, power in enumerate(powers)), np.zeros_like(x))
        return up_by(total, 4 * m + 32)
