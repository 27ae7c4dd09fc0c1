"""Add a Jacobian matrix to a homotopy for F(x) = 0."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Protocol

from attrs import frozen

from continuation.arrays import Array, Matrix
from problems.nonlinear.start_checks import EQUATIONS, Jacobian, check_jacobian_shape
from problems.options import quiet


class WithoutJacobian(Protocol):
    """A homotopy for F(x) = 0 that F' completes."""

    @property
    def references(self) -> Sequence[str]:
        """BibTeX entries."""
        ...

    def start(self) -> tuple[Array, float]:
        """The start."""
        ...

    def residual(self, y: Array, lam: float) -> Array:
        """The residual H."""
        ...

    def derivative(self, slope: Matrix, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam) from F'."""
        ...


@frozen(eq=False)
class Differentiable:
    """A homotopy with `jacobian`, made of one without and of F'.

    Parameters
    ----------
    homotopy : FixedPointHomotopy or NewtonHomotopy
    slope : callable
        ``slope(x) -> (n, n)``, F'.

    Raises
    ------
    TypeError
        If `slope` does not return a usable matrix.
    ValueError
        If its shape is not (n, n).
    """

    homotopy: WithoutJacobian
    slope: Jacobian
    target: ClassVar[float | None] = 0.0
    problem_class: ClassVar[str] = EQUATIONS

    def __attrs_post_init__(self) -> None:
        y, lam = self.start()
        check_jacobian_shape(self.slope, y)
        self.jacobian(y, lam)

    @property
    def references(self) -> Sequence[str]:
        """BibTeX entries."""
        return self.homotopy.references

    def start(self) -> tuple[Array, float]:
        """The start."""
        return self.homotopy.start()

    def residual(self, y: Array, lam: float) -> Array:
        """The residual H."""
        return self.homotopy.residual(y, lam)

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam); H_y has the type of F'."""
        return self.homotopy.derivative(self.slope(y), y, lam)
