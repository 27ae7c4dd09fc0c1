"""The fixed-point homotopy."""

from __future__ import annotations

from typing import Any, ClassVar

from attrs import field, frozen

from continuation.arrays import Array, Matrix
from problems.bibliography import CHOW_MALLET_PARET_YORKE
from problems.nonlinear.differentiable import Differentiable
from problems.nonlinear.identity import blend_with_identity
from problems.nonlinear.start_checks import EQUATIONS, Function, Jacobian, start_vector, value_at
from problems.options import quiet


@frozen(eq=False)
class FixedPointHomotopy:
    """H(x, lam) = (1 - lam) F(x) + lam (x - a), from x = a at lam = 1 to F(x) = 0 at lam = 0.

    Parameters
    ----------
    F : callable
        ``F(x) -> (n,)``.
    a : array_like, shape (n,)
        Start; for almost every a the path is regular.

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
    problem_class: ClassVar[str] = EQUATIONS
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (CHOW_MALLET_PARET_YORKE,)

    def __attrs_post_init__(self) -> None:
        value_at(self.F, self.a)

    def start(self) -> tuple[Array, float]:
        """(a, 1)."""
        return self.a.copy(), 1.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        return (1.0 - lam) * self.F(y) + lam * (y - self.a)

    @quiet
    def derivative(self, slope: Matrix, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam) from slope = F'(y).

        Parameters
        ----------
        slope : ndarray or sparse array, shape (n, n)
        y : ndarray, shape (n,)
        lam : float
        """
        return blend_with_identity(slope, lam), y - self.a - self.F(y)


def fixed_point(F: Function, a: Any, jacobian: Jacobian | None = None) -> FixedPointHomotopy | Differentiable:
    """The fixed-point homotopy of F from `a`.

    Parameters
    ----------
    F : callable
    a : array_like, shape (n,)
    jacobian : callable, optional
        ``jacobian(x) -> (n, n)``: any matrix that `continuation.linear` factors.
    """
    homotopy = FixedPointHomotopy(F, a)
    return homotopy if jacobian is None else Differentiable(homotopy, jacobian)
