"""Chandrasekhar's H-equation: dense, any size, fold in closed form."""

from __future__ import annotations

from functools import cached_property
from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.options import finite_or_none, positive_integer, quiet

_CHANDRASEKHAR = """@book{Chandrasekhar1960,
  author = {Chandrasekhar, Subrahmanyan},
  title = {Radiative Transfer},
  publisher = {Dover},
  year = {1960},
}"""


@frozen(eq=False, slots=False)
class Chandrasekhar:
    """``y_i (1 - (lam/2n) sum_j mu_i y_j/(mu_i + mu_j)) = 1`` with mu_i = (i - 1/2)/n, from y = 1 at lam = 0.

    The mean m of y satisfies m = 1 + lam m^2/4: the path turns at lam = 1, m = 2, for every n.

    References
    ----------
    Chandrasekhar, Radiative Transfer, 1960; Kelley, Iterative Methods for Linear and Nonlinear Equations, 1995.
    """

    n: int = field(default=100, validator=positive_integer)
    target: float | None = field(default=None, validator=finite_or_none)
    references: ClassVar[tuple[str, ...]] = (_CHANDRASEKHAR,)

    @cached_property
    def kernel(self) -> Array:
        """mu_i / (mu_i + mu_j) / 2n, shape (n, n)."""
        mu = (np.arange(self.n) + 0.5) / self.n
        return np.asarray(mu[:, None] / (mu[:, None] + mu) / (2.0 * self.n))

    def start(self) -> tuple[Array, float]:
        """Ones, lam = 0."""
        return np.ones(self.n), 0.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        return y - 1.0 - lam * (y * (self.kernel @ y))

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """(H_y, H_lam), shapes (n, n) and (n,)."""
        inner = self.kernel @ y
        matrix = (-lam * y)[:, None] * self.kernel
        matrix.flat[:: self.n + 1] += 1.0 - lam * inner
        return matrix, -y * inner
