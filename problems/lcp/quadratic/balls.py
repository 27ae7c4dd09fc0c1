"""Single-precision products and interval polynomials."""

from __future__ import annotations

from math import comb

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import EPS, Array
from continuation.certificate.engine import up_by
from continuation.numbers.ends import Ends, accumulated, up_sum

Single = NDArray[np.float32]

UNIT = float(np.finfo(np.float32).epsneg)
"""Relative error in single precision."""

SINGLE_UNDERFLOW = float(np.finfo(np.float32).tiny)
"""Underflow error, even if subnormal numbers become zero."""


def rounded(count: int) -> float:
    """`accumulated` in single precision (Higham, section 3.1), for eight more operations."""
    whole = (count + 8) * UNIT
    return whole / (1.0 - whole) * (1.0 + 8.0 * EPS) if whole < 0.5 else np.inf


def image_of(matrix: Single, x: Array) -> Array:
    """Bound of nonnegative matrices times vectors."""
    m = x.shape[1]
    unit = x.max(axis=1, keepdims=True)
    unit = np.where(unit == 0.0, 1.0, unit)
    # Clamped numbers do not underflow.
    scaled = np.maximum(x / unit, 2.0**-60).astype(np.float32)
    image: Array = np.matmul(matrix, scaled[..., None])[..., 0].astype(float)
    bound: Array = (image * (1.0 + 4.0 * rounded(m)) + 2.0 * m * SINGLE_UNDERFLOW) * unit * (1.0 + 4.0 * EPS)
    return bound


@frozen(eq=False)
class Ball:
    """Intervals by middle and radius, shape (slabs, any, any)."""

    middle: Array
    radius: Array

    @classmethod
    def of(cls, v: Ends) -> Ball:
        """Convert ends."""
        middle = v.middle()
        return cls(middle, v.radius(middle))

    def through(self, matrix: Array, size: Array | None = None) -> Ball:
        """Matrices times intervals; `size`: |matrix|."""
        count = matrix.shape[-1] + 4
        room = self.radius + accumulated(count) * np.abs(self.middle)
        return Ball(
            np.matmul(matrix, self.middle), up_by(np.matmul(np.abs(matrix) if size is None else size, room), count)
        )

    @property
    def size(self) -> Array:
        """Largest absolute value."""
        return (np.abs(self.middle) + self.radius) * (1.0 + 4.0 * EPS)

    @property
    def ends(self) -> Ends:
        """Convert to ends."""
        return Ends(-up_sum(self.radius - self.middle), up_sum(self.middle + self.radius))

    @property
    def derivative(self) -> Ball:
        """Derivative of polynomials, coefficients last."""
        count = np.arange(1.0, self.middle.shape[-1])
        middle, radius = self.middle[..., 1:] * count, self.size[..., 1:] * (8.0 * EPS * count)
        return Ball(middle, up_by(radius + self.radius[..., 1:] * count, 4))


POLYNOMIAL_PARTS = 8
"""Parts of a slab for the range of H along the cubic: one sum of coefficient sizes is several times too large."""


def _shifts() -> Array:
    """Exact map from degree-8 coefficients on [-1, 1] to those on parts."""
    out = np.zeros((9, POLYNOMIAL_PARTS, 9))
    for part in range(POLYNOMIAL_PARTS):
        middle = (2 * part + 1) / POLYNOMIAL_PARTS - 1.0
        for k in range(9):
            out[k, part, : k + 1] = [comb(k, i) * middle ** (k - i) / POLYNOMIAL_PARTS**i for i in range(k + 1)]
    return out.reshape(9, -1)


_SHIFTS = _shifts()


def largest(image: Ball, by_E: Ball, by_C: Ball, offset: Array) -> Array:
    """Bound of |v - x E v + x^2 C v|, |x| <= offset, for polynomials v, E v, C v."""
    middle, room = (np.zeros((*image.middle.shape[:2], 9)) for _ in range(2))
    for power, sign, v in ((0, 1.0, image), (1, -1.0, by_E), (2, 1.0, by_C)):
        there = slice(power, power + v.middle.shape[-1])
        middle[..., there] += sign * v.middle
        room[..., there] += v.radius + 64.0 * EPS * np.abs(v.middle)
    powers = offset[:, :, None] ** np.arange(9.0)
    parts = np.abs(np.matmul(middle * powers, _SHIFTS)).reshape(*middle.shape[:2], POLYNOMIAL_PARTS, 9)
    # The rounding of sizes bounds the rounding of parts.
    return up_by(parts.sum(axis=-1).max(axis=-1) + (room * powers).sum(axis=-1), 64)
