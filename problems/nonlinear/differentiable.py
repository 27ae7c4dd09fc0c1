"""A homotopy for F(x) = 0, completed by the derivative of F."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

from attrs import frozen

from continuation.arrays import Array, Matrix
from problems.nonlinear.start_checks import EQUATIONS, Jacobian, check_jacobian_shape
from problems.options import quiet


@frozen(eq=False)
class Differentiable:
    """A homotopy with `jacobian`, made of one without and of F'.

    Capabilities are found by their presence, so the two cases are two types.

    Parameters
    ----------
    homotopy : FixedPointHomotopy or NewtonHomotopy
    slope : callable
        ``slope(x) -> (n, n)``, the derivative F'.

    Raises
    ------
    TypeError
        If `slope` is not callable, or returns no matrix, or one of a type that the homotopy cannot use.
    ValueError
        If it does not have the shape (n, n).
    """

    homotopy: Any
    slope: Jacobian
    target: ClassVar[float | None] = 0.0
    problem_class: ClassVar[str] = EQUATIONS

    def __attrs_post_init__(self) -> None:
        y, lam = self.start()
        check_jacobian_shape(self.slope, y)
        self.jacobian(y, lam)

    @property
    def references(self) -> Sequence[str]:
        """Those of the homotopy."""
        return self.homotopy.references

    def start(self) -> tuple[Array, float]:
        """That of the homotopy."""
        return self.homotopy.start()

    def residual(self, y: Array, lam: float) -> Array:
        """That of the homotopy."""
        return self.homotopy.residual(y, lam)

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam), the matrix of the type that F' has."""
        return self.homotopy.derivative(self.slope(y), y, lam)
