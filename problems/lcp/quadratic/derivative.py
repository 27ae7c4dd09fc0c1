"""A quadratic homotopy and its derivative along a cubic, of degree 6 and 3."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import EPS, Array
from continuation.certificate.engine import up_by
from continuation.numbers.ends import Ends, accumulated, bilinear, thin, up_sum
from problems.lcp.quadratic.form import SUM_ROUNDING, Affine, Quadratic


def _apply(part: Affine, q: Ends) -> Ends:
    middle, count = q.middle(), q.shape[-1] + 4
    size = np.abs(middle)
    room = part.linear_size(q.radius(middle) + accumulated(count) * size)
    if part.sizes is not None:
        room = room + part.linear_error(size + q.radius(middle))
    room, centre = up_by(room, 2 * count), part.linear(middle)
    image = Ends(-up_sum(room - centre), up_sum(centre + room))
    image[:, 0] = image[:, 0] + part.constant_ends
    return image


_SUMS = np.array([[float(i + j == k) for i in range(4) for j in range(4)] for k in range(7)])


def _coefficients(value: Ends, alpha: Ends, beta: Ends) -> Ends:
    products = alpha[:, :, None] * beta[:, None, :]
    count, n = alpha.shape[0], alpha.shape[2]
    flat = Ends(*(x.reshape(count, 16, n) for x in (products.lo, products.hi)))
    total = bilinear(lambda a, b: np.matmul(b.transpose(0, 2, 1), a.T), thin(_SUMS), flat)
    lower, upper = (np.zeros((count, n, 7)) for _ in range(2))
    lower[..., :4], upper[..., :4] = value.lo.transpose(0, 2, 1), value.hi.transpose(0, 2, 1)
    return total + Ends(lower, upper)


@frozen(eq=False)
class Derivative:
    """H' along the cubic: coefficient k is plain (k = 0) + diag(alpha_k) second + diag(beta_k) first.

    Attributes
    ----------
    form : Quadratic
    residual : Ends, shape (slabs, N, 7)
        Coefficients of H.
    a, b : ndarray, shape (slabs, 4, N)
        Middles of alpha and beta.
    ra, rb : ndarray
        Radii.
    """

    form: Quadratic
    residual: Ends
    a: Array
    b: Array
    ra: Array
    rb: Array

    @classmethod
    def of(cls, form: Quadratic, cubic: Ends) -> Derivative:
        """From cubic coefficients, shape (slabs, 4, N + 1)."""
        alpha, beta, value = (_apply(part, cubic) for part in (form.first, form.second, form.plain))
        a, b = alpha.middle(), beta.middle()
        return cls(form, _coefficients(value, alpha, beta), a, b, alpha.radius(a), beta.radius(b))

    def matrix(self, k: int) -> Array:
        """Coefficient k, shape (slabs, N, N + 1)."""
        form, a, b = self.form, self.a[:, k, :, None], self.b[:, k, :, None]
        out: Array = a * form.second.matrix + b * form.first.matrix
        return out + form.plain.matrix if k == 0 else out

    def image(self, x: Array) -> tuple[Array, Array]:
        """Bounds of |exact| x and |exact - matrix| x."""
        form, count = self.form, 2 * x.shape[1]
        by_second, by_first = (part.linear_size(x)[:, None] for part in (form.second, form.first))
        error = self.ra * by_second + self.rb * by_first
        size = np.abs(self.a) * by_second + np.abs(self.b) * by_first + error
        for part, factor in ((form.second, self.a), (form.first, self.b)):
            if part.sizes is not None:
                error = error + np.abs(factor) * part.linear_error(x)[:, None]
        size[:, 0] += form.plain.linear_size(x)
        if form.plain.sizes is not None:
            error[:, 0] += form.plain.linear_error(x)
        return up_by(size, count), up_by(error + 4.0 * EPS * size, count)

    def products(self, x: Array, radius: Array) -> Array:
        """Bound of |2 Q(d, x)| for |d| <= radius."""
        first, second = self.form.first.linear_size, self.form.second.linear_size
        if x is radius:
            crossed = 2.0 * first(x) * second(x)
        else:
            crossed = first(radius) * second(x) + first(x) * second(radius)
        return up_by(crossed * (1.0 + SUM_ROUNDING) ** 2, 2 * x.shape[1])
