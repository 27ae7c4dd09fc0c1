"""Quadratic residuals from products of affine parts."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen

from continuation.arrays import EPS, Array
from continuation.certificate.cells import Index
from continuation.numbers.ends import Ends, thin


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

    @cached_property
    def _alone(self) -> Index | None:
        there = self.size != 0.0
        return there.argmax(axis=1) if (there.sum(axis=1) <= 1).all() else None

    def linear(self, x: Array) -> Array:
        """The matrix times vectors.

        Parameters
        ----------
        x : ndarray, shape (..., N + 1)
        """
        return self._times(self.matrix, x)

    def linear_size(self, x: Array) -> Array:
        """Sizes times vectors >= 0.

        Parameters
        ----------
        x : ndarray, shape (..., N + 1)
        """
        return self._times(self.size, x)

    def linear_error(self, x: Array) -> Array:
        """Errors times vectors >= 0.

        Parameters
        ----------
        x : ndarray, shape (..., N + 1)
        """
        return self._times(self.error, x)

    def _times(self, matrix: Array, x: Array) -> Array:
        if self._alone is not None:
            return np.asarray(x[..., self._alone] * matrix[np.arange(len(matrix)), self._alone])
        return np.asarray(np.matmul(x.reshape(-1, x.shape[-1]), matrix.T).reshape(*x.shape[:-1], -1))

    @cached_property
    def constant_ends(self) -> Ends:
        """The constant as ends."""
        if self.constant_sizes is None:
            return thin(self.constant)
        room = SUM_ROUNDING * self.constant_sizes
        return Ends(self.constant - room, self.constant + room)


SUM_ROUNDING = 8.0 * EPS
"""Relative error of a sum of up to eight exact terms."""


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

    def times(self, left: Array, a: Array, b: Array, chart: Array, scale: Array, powers: int) -> Array:
        """`left` times scaled coefficients of G' along cubics, shape (powers, slabs, m, N + 1).

        Parameters
        ----------
        left : ndarray, shape (slabs, m, N + 1)
        a, b : ndarray, shape (slabs, 4, N)
            Coefficients of `first`, `second`.
        chart : ndarray, shape (slabs, N + 1)
            Last row of coefficient 0.
        scale : ndarray, shape (slabs, N + 1)
        powers : int
            Number of coefficients.
        """
        out = np.empty((powers, *left.shape[:2], chart.shape[1]))
        for k in range(powers):
            entries = a[:, k, :, None] * self.second.matrix + b[:, k, :, None] * self.first.matrix
            np.matmul(left[:, :, :-1], entries if k else entries + self.plain.matrix, out=out[k])
        out[0] += left[:, :, -1:] * chart[:, None, :]
        out *= scale[:, None, :]
        return out
