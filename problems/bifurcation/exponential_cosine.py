"""A test of path jumping."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.bibliography import WATSON
from problems.options import finite_or_none, positive_integer, quiet


@frozen
class ExponentialCosine:
    """H_k = x_k - lam exp(cos(k S)), S = sum_j x_j, k = 1..n, from (0, 0) to lam = 1.

    Parameters
    ----------
    n : int
        Unknowns. n = 2 has no turning point, n = 8 has 24.
    target : float or None
        lam at the end.

    References
    ----------
    Watson, Appl. Math. Comput. 5, 1979.
    """

    n: int = field(default=5, validator=positive_integer)
    target: float | None = field(default=1.0, validator=finite_or_none)
    problem_class: ClassVar[str] = "fixed points, to test with"
    references: ClassVar[tuple[str, ...]] = (WATSON,)

    def start(self) -> tuple[Array, float]:
        """The origin."""
        return np.zeros(self.n), 0.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        return y - lam * np.exp(np.cos(self._harmonics * np.sum(y)))

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """(H_y, H_lam): identity plus rank one, shape (n, n); shape (n,)."""
        angles = self._harmonics * np.sum(y)
        fixed_point = np.exp(np.cos(angles))
        slope = self._harmonics * np.sin(angles) * fixed_point
        return np.eye(self.n) + lam * slope[:, None], -fixed_point

    @property
    def _harmonics(self) -> Array:
        return np.arange(1.0, self.n + 1)
