"""The fixed-point homotopy."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen
from scipy.sparse import eye_array

from continuation.arrays import Array, Matrix
from continuation.linear import Banded
from problems.bibliography import CHOW_MALLET_PARET_YORKE
from problems.nonlinear.start_checks import EQUATIONS, Function, Jacobian, check_jacobian_shape, start_vector, value_at
from problems.options import quiet


@frozen(eq=False, slots=False)
class FixedPointHomotopy:
    """H(x, lam) = (1 - lam) F(x) + lam (x - a), from x = a at lam = 1 to F(x) = 0 at lam = 0.

    Parameters
    ----------
    F : callable
        ``F(x) -> (n,)``.
    a : array_like, shape (n,)
        Start; for almost every a the path is regular.
    slope : callable, optional
        ``slope(x) -> (n, n)``, F': dense, sparse or `Banded`. With it the homotopy has a `jacobian`.

    Raises
    ------
    TypeError
        If F does not return an array.
    ValueError
        If `a` or F(a) is not finite, or shapes differ.

    References
    ----------
    Chow, Mallet-Paret and Yorke, Math. Comp. 32, 1978.
    """

    F: Function
    a: Array = field(converter=start_vector)
    slope: Jacobian | None = None
    problem_class: ClassVar[str] = EQUATIONS
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (CHOW_MALLET_PARET_YORKE,)

    def __attrs_post_init__(self) -> None:
        value_at(self.F, self.a)
        if self.slope is not None:
            check_jacobian_shape(self.slope, self.a)
            object.__setattr__(self, "jacobian", self._jacobian)

    def start(self) -> tuple[Array, float]:
        """(a, 1)."""
        return self.a.copy(), 1.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        return (1.0 - lam) * self.F(y) + lam * (y - self.a)

    @quiet
    def _jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam); H_y has the structure of F'."""
        assert self.slope is not None
        matrix, column = self.slope(y), y - self.a - self.F(y)
        if isinstance(matrix, Banded):
            bands = (1.0 - lam) * matrix.ab
            bands[matrix.upper] += lam
            return Banded(bands, matrix.lower, matrix.upper), column
        identity = np.eye(y.size) if isinstance(matrix, np.ndarray) else eye_array(y.size, format="csr")
        return (1.0 - lam) * matrix + lam * identity, column


def fixed_point(F: Function, a: Any, jacobian: Jacobian | None = None) -> FixedPointHomotopy:
    """The fixed-point homotopy of F from `a`.

    Parameters
    ----------
    F : callable
    a : array_like, shape (n,)
    jacobian : callable, optional
        ``jacobian(x) -> (n, n)``: dense, sparse or `Banded`.
    """
    return FixedPointHomotopy(F, a, jacobian)
