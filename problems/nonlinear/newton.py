"""The Newton or global homotopy."""

from __future__ import annotations

from typing import Any, ClassVar

from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.citation.bibliography import ALLGOWER_GEORG
from problems.bibliography import KELLER_1978
from problems.nonlinear.start_checks import FromPoint, Function, Jacobian
from problems.options import quiet


@frozen(eq=False, slots=False)
class NewtonHomotopy(FromPoint):
    """H(x, lam) = F(x) - lam F(a), from x = a at lam = 1 to F(x) = 0 at lam = 0.

    Parameters
    ----------
    F : callable
        ``F(x) -> (n,)``.
    a : array_like, shape (n,)
        Start, with F' regular.
    slope : callable, optional
        ``slope(x) -> (n, n)``, F': any matrix that `continuation.linear` factors. With it the homotopy has a
        `jacobian`.

    References
    ----------
    Keller, Global Homotopies and Newton Methods, 1978; Allgower and Georg, Introduction to Numerical Continuation
    Methods, 2003.
    """

    references: ClassVar[tuple[str, ...]] = (KELLER_1978, ALLGOWER_GEORG)

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        return self.F(y) - lam * self.value

    @quiet
    def _jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(F', -F(a))."""
        assert self.slope is not None
        return self.slope(y), -self.value


def newton(F: Function, a: Any, jacobian: Jacobian | None = None) -> NewtonHomotopy:
    """The Newton homotopy of F from `a`.

    Parameters
    ----------
    F : callable
    a : array_like, shape (n,)
    jacobian : callable, optional
        ``jacobian(x) -> (n, n)``, any matrix that `continuation.linear` factors.
    """
    return NewtonHomotopy(F, a, jacobian)
