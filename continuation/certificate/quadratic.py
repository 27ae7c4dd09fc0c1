"""Krawczyk's test for homotopies that are quadratic in all unknowns and the parameter: exact in the tube's width.

H(p + d) = H(p) + H'(p) d + Q(d, d), so that the derivative needs no interval arithmetic, only bounds of rounding; and
along a cubic H is a polynomial of degree 6, H' one of degree 3. The preconditioner follows the path,
Y(s) = (I - x E) Y_0 with x = s - middle, which leaves terms of second order in x. No tensor of third order is formed.
"""

from __future__ import annotations

from functools import cached_property
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.certificate.cells import Slabs, expansion
from continuation.certificate.krawczyk import Judged, Several, applied, inverses, times, up_by
from continuation.intervals.ends import EPS, Ends, accumulated, bilinear, thin

ENTRIES = 4_000_000
"""Numbers of one array of matrices at a time: 32 MB."""


@frozen(eq=False, slots=False)
class Affine:
    """u -> constant + matrix u, for u = (y, lam); where an entry is a rounded sum, `sizes` are those of its terms.

    Parameters
    ----------
    constant : ndarray, shape (N,)
    matrix : ndarray, shape (N, N + 1)
    sizes : ndarray, shape (N, N + 1), optional
        Sums of the absolute values of what an entry is the sum of; zero where it is exact.
    constant_sizes : ndarray, shape (N,), optional
    """

    constant: Array
    matrix: Array
    sizes: Array | None = None
    constant_sizes: Array | None = None

    @cached_property
    def size(self) -> Array:
        """Of each entry, at least."""
        return np.abs(self.matrix) if self.sizes is None else np.maximum(self.sizes, np.abs(self.matrix))

    @cached_property
    def error(self) -> Array:
        """Of each entry."""
        return np.zeros_like(self.matrix) if self.sizes is None else ROUNDED * self.sizes

    @cached_property
    def constant_ends(self) -> Ends:
        """The constant."""
        if self.constant_sizes is None:
            return thin(self.constant)
        room = ROUNDED * self.constant_sizes
        return Ends(self.constant - room, self.constant + room)


ROUNDED = 8.0 * EPS
"""Error of a sum of up to eight exact terms, against the sum of their sizes: seven roundings, and that of the bound."""


@frozen(eq=False)
class Quadratic:
    """H(u) = plain(u) + first(u) second(u), component by component, each part affine in u = (y, lam).

    Parameters
    ----------
    plain, first, second : Affine
    """

    plain: Affine
    first: Affine
    second: Affine


@runtime_checkable
class SupportsQuadratic(Protocol):
    """A homotopy whose residual is quadratic in (y, lam) says how: its proofs are then cheap."""

    def quadratic(self) -> Quadratic:
        """The residual as affine parts and products of them, its data taken as the numbers that they are.

        Returns
        -------
        Quadratic
        """
        ...


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

    def judge(self, slabs: Slabs, radius: Array) -> Judged:
        """As `continuation.certificate.krawczyk.Engine.judge`; valid for all radii."""
        m = radius.shape[1]
        size = max(1, ENTRIES // (m * m))
        places = np.array_split(np.arange(len(slabs)), -(-len(slabs) // size))
        with np.errstate(all="ignore"):
            return Several.of([(place, self._judge(slabs.take(place))) for place in places])

    def _judge(self, slabs: Slabs) -> Polynomial:
        form, chart = self.form, slabs.cells.chart
        q = expansion(slabs).q
        cubic = Ends(np.stack([k.lo for k in q], axis=1), np.stack([k.hi for k in q], axis=1))
        alpha, beta, value = (_apply(part, cubic) for part in (form.first, form.second, form.plain))
        derivative, H = Derivative.of(form, alpha, beta), _coefficients(value, alpha, beta)
        return Polynomial.of(derivative, chart, H, slabs.offset[:, None])


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


def _misfit(coefficients: Ends, left: Array, E: Array, offset: Array) -> Array:
    """|Y(s) H(p(s))|: the coefficients of the polynomial (I - x E) Y_0 H, each by its size."""
    if not offset.any():
        return up_by(bilinear(np.matmul, thin(left), coefficients[..., :1])[..., 0].magnitude(), 1)
    image = bilinear(np.matmul, thin(left), coefficients)
    moved = bilinear(np.matmul, thin(E), image)
    sizes = (image[..., 1:] - moved[..., :-1]).magnitude()
    powers = offset[:, :, None] ** np.arange(1, 8)
    total = image[..., 0].magnitude() + (sizes * powers[..., :6]).sum(axis=-1)
    return up_by(total + moved[..., 6].magnitude() * powers[..., 6], 32)


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


@frozen(eq=False)
class Polynomial:
    """The bounds as polynomials in the offset: what is left of I - Y(s) G'(p(s) + d), applied to vectors."""

    misfit: Array
    derivative: Derivative
    chart: Array
    Y: Array
    size_Y: Array
    rest: Array
    size_E: Array
    second: Array
    offset: Array

    @classmethod
    def of(cls, derivative: Derivative, chart: Array, H: Ends, offset: Array) -> Polynomial:
        """With the coefficients of H along the cubic."""
        G0 = np.concatenate([derivative.matrix(0), chart[:, None, :]], axis=1)
        Y = inverses(G0)
        left, size_Y, m = Y[:, :, :-1], np.abs(Y), Y.shape[1]
        R = np.abs(np.eye(m) - np.matmul(Y, G0))
        moving = bool(offset.any())
        E = np.matmul(left, derivative.matrix(1)) if moving else np.zeros_like(Y)
        second = np.abs(np.matmul(left, derivative.matrix(2)) - np.matmul(E, E)) if moving else E
        return cls(_misfit(H, left, E, offset), derivative, chart, Y, size_Y, R, np.abs(E), second, offset)

    @property
    def across(self) -> Ends:
        """Y(s) = (I - x E) Y_0."""
        return self._moved(thin(self.Y[:, :, -1]))

    def applied(self, v: Ends) -> Ends:
        """Y(s) = (I - x E) Y_0."""
        return self._moved(applied(self.Y, v))

    def _moved(self, image: Ends) -> Ends:
        slack = self.offset * up_by(times(self.size_E, image.magnitude()), self.Y.shape[1])
        return image + Ends(-slack, slack)

    def spread(self, x: Array, radius: Array) -> Array:
        """See `Judged.spread`.

        The terms are those of I - (I - x E) Y_0 (G_0 + x G_1 + x^2 G_2 + x^3 G_3), with Y_0 G_1 = E up to rounding,
        and of Y(s) 2 Q(d, .).
        """
        t, m = self.offset, x.shape[1]
        gamma = accumulated(m)
        left = self.size_Y[:, :, :-1]
        with np.errstate(all="ignore"):
            sizes, errors = self.derivative.image(x)
            vectors = np.stack([*sizes.transpose(1, 0, 2), *errors.transpose(1, 0, 2)[:3]], axis=-1)
            through = np.matmul(
                left, np.concatenate([vectors, self.derivative.products(x, radius)[..., None]], axis=-1)
            )
            size, error, quadratic = through[..., :4], through[..., 4:7], through[..., 7]
            along = up_by((np.abs(self.chart) * x).sum(axis=1, keepdims=True), m)
            # |I - Y_0 G_0| x, with the rounding of the product and the errors of G_0.
            base = times(self.rest, x) + gamma * (size[..., 0] + self.size_Y[:, :, -1] * along + x) + error[..., 0]
            if not t.any():
                return up_by(base + quadratic, 4 * m + 16)
            first = gamma * size[..., 1] + error[..., 1]
            inner = np.stack([x, base, first, size[..., 2], size[..., 3], quadratic], axis=-1)
            by_E = np.matmul(self.size_E, inner)
            # |Y_0 G_2 - E E| x: rounding of both products.
            second = times(self.second, x) + gamma * (2.0 * size[..., 2] + 2.0 * times(self.size_E, by_E[..., 0]))
            second = second + error[..., 2] + by_E[..., 2]
            linear = first + by_E[..., 1] + by_E[..., 5]
            total = (
                base + quadratic + t * (linear + t * (second + t * (size[..., 3] + by_E[..., 3] + t * by_E[..., 4])))
            )
        return up_by(total, 4 * m + 16)
