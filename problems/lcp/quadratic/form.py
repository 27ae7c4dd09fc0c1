"""Residuals that are sums of products of two affine functions.

They have values, polynomials along cubic arcs, and bounds of rounding errors.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen

from continuation.arrays import EPS, Array
from continuation.certificate.engine import up_by
from continuation.numbers.ends import Ends, accumulated, bilinear, thin, up_sum

SUM_ROUNDING = 8.0 * EPS
"""Relative error of a sum of up to eight exact terms."""

_SUMS = np.array([[float(i + j == k) for i in range(4) for j in range(4)] for k in range(7)])


@frozen(eq=False, slots=False)
class Affine:
    """u -> constant + matrix u, for u = (y, lam).

    Parameters
    ----------
    constant : ndarray, shape (N,)
    matrix : ndarray, shape (N, N + 1)
    sizes : ndarray, shape (N, N + 1), optional
        Sums of the absolute terms of rounded entries; zero for exact ones.
    constant_sizes : ndarray, shape (N,), optional
    """

    constant: Array
    matrix: Array
    sizes: Array | None = None
    constant_sizes: Array | None = None

    @cached_property
    def size(self) -> Array:
        """Bounds of entries and terms."""
        return np.abs(self.matrix) if self.sizes is None else np.maximum(self.sizes, np.abs(self.matrix))

    @cached_property
    def error(self) -> Array:
        """Error bounds of the entries."""
        return np.zeros_like(self.matrix) if self.sizes is None else SUM_ROUNDING * self.sizes

    def along(self, cubic: Ends) -> Ends:
        """Its coefficients along cubics, shape (slabs, 4, N).

        Parameters
        ----------
        cubic : Ends, shape (slabs, 4, N + 1)
        """
        middle, count = cubic.middle(), cubic.shape[-1] + 4
        size = np.abs(middle) + (radius := cubic.radius(middle))
        room = np.matmul(radius + accumulated(count) * size, self.size.T) + np.matmul(size, self.error.T)
        room, centre = up_by(room, 2 * count), np.matmul(middle, self.matrix.T)
        lo, hi = -up_sum(room - centre), up_sum(centre + room)
        apart = 0.0 if self.constant_sizes is None else SUM_ROUNDING * self.constant_sizes
        constant = Ends(lo[:, 0], hi[:, 0]) + Ends(self.constant - apart, self.constant + apart)
        lo[:, 0], hi[:, 0] = constant.lo, constant.hi
        return Ends(lo, hi)


@frozen(eq=False, slots=False)
class Quadratic:
    """H(u) = plain(u) + first(u) second(u), componentwise, u = (y, lam).

    Parameters
    ----------
    plain, first, second : Affine
    """

    plain: Affine
    first: Affine
    second: Affine

    def image(self, value: Ends, alpha: Ends, beta: Ends) -> Ends:
        """Coefficients of H along cubics, shape (slabs, N, 7).

        Parameters
        ----------
        value, alpha, beta : Ends, shape (slabs, 4, N)
            Coefficients of `plain`, `first`, `second`.
        """
        products = alpha[:, :, None] * beta[:, None, :]
        count, n = alpha.shape[0], alpha.shape[2]
        flat = Ends(*(x.reshape(count, 16, n) for x in (products.lo, products.hi)))
        total = bilinear(lambda a, b: np.matmul(b.transpose(0, 2, 1), a.T), thin(_SUMS), flat)
        lower, upper = (np.zeros((count, n, 7)) for _ in range(2))
        lower[..., :4], upper[..., :4] = value.lo.transpose(0, 2, 1), value.hi.transpose(0, 2, 1)
        return total + Ends(lower, upper)

    def derivatives(self, a: Array, b: Array) -> Array:
        """Coefficients of H', shape (slabs, 4, N, N + 1).

        Parameters
        ----------
        a, b : ndarray, shape (slabs, 4, N)
            Coefficients of `first` and `second`.
        """
        out: Array = a[..., None] * self.second.matrix + b[..., None] * self.first.matrix
        out[:, 0] += self.plain.matrix
        return out

    def rounding(self, alpha: Ends, beta: Ends, offset: Array) -> Array:
        """Bound of the errors of `derivatives` along slabs, and of products with them, shape (slabs, N, N + 1).

        Parameters
        ----------
        alpha, beta : Ends, shape (slabs, 4, N)
            Coefficients of `first` and `second`.
        offset : ndarray, shape (slabs, 1, 1)
            Largest distance of the parameter from the middle.
        """
        powers, gamma = offset ** np.arange(4.0), accumulated(self.plain.matrix.shape[1] + 16)
        out = gamma * self.plain.size + self.plain.error
        for part, factor in ((self.second, alpha), (self.first, beta)):
            middle = factor.middle()
            radius = np.matmul(powers, factor.radius(middle)).transpose(0, 2, 1)
            size = np.matmul(powers, np.abs(middle)).transpose(0, 2, 1) + radius
            out = out + (gamma * size + radius) * part.size
            if part.sizes is not None:
                out = out + size * part.error
        return out

    def products(self, x: Array, radius: Array) -> Array:
        """Bound of |2 Q(d, x)| for |d| <= radius.

        Parameters
        ----------
        x, radius : ndarray, shape (slabs, N + 1)
            Nonnegative.
        """
        first, second = self.first.size.T, self.second.size.T
        crossed = (radius @ first) * (x @ second) + (x @ first) * (radius @ second)
        return up_by(crossed * (1.0 + SUM_ROUNDING) ** 2, 2 * x.shape[1])
