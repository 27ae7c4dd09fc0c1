"""The Newton or global homotopy."""

from __future__ import annotations

from typing import Any, ClassVar

from attrs import field, frozen

from continuation.arrays import Array
from continuation.citation.bibliography import ALLGOWER_GEORG
from problems.bibliography import KELLER_1978
from problems.nonlinear import start_checks
from problems.nonlinear.start_checks import Derivative, Function, Jacobian
from problems.options import quiet


@frozen(eq=False)
class NewtonHomotopy:
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

    F: Function
    a: Array = field(converter=start_checks.start_vector)
    slope: Jacobian | None = None
    value: Array = field(init=False, repr=False, default=start_checks.VALUE)
    """F(a), shape (n,)."""
    problem_class: ClassVar[str] = "nonlinear equations F(x) = 0"
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (KELLER_1978, ALLGOWER_GEORG)
    start = start_checks.start

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (n,)."""
        return self.F(y) - lam * self.value

    @property
    def jacobian(self) -> Derivative | None:
        """Maps (y, lam) to (F', -F(a)); None without F'."""
        slope = self.slope
        return None if slope is None else quiet(lambda y, lam: (slope(y), -self.value))


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
