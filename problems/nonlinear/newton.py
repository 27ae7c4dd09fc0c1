"""The Newton or global homotopy."""

from __future__ import annotations

from typing import Any, ClassVar

from attrs import field, frozen

from continuation.arrays import Array, Matrix
from continuation.citation.bibliography import ALLGOWER_GEORG
from problems.bibliography import KELLER_1978
from problems.nonlinear.start_checks import EQUATIONS, Function, Jacobian, check_jacobian_shape, start_vector, value_at
from problems.options import quiet


@frozen(eq=False, slots=False)
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

    Raises
    ------
    TypeError
        If F does not return an array.
    ValueError
        If `a` or F(a) is not finite, or shapes differ.

    References
    ----------
    Keller, Global Homotopies and Newton Methods, 1978; Allgower and Georg, Introduction to Numerical Continuation
    Methods, 2003.
    """

    F: Function
    a: Array = field(converter=start_vector)
    slope: Jacobian | None = None
    value: Array = field(init=False, repr=False)
    """F(a), shape (n,)."""
    problem_class: ClassVar[str] = EQUATIONS
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (KELLER_1978, ALLGOWER_GEORG)

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "value", value_at(self.F, self.a))
        if self.slope is not None:
            check_jacobian_shape(self.slope, self.a)
            object.__setattr__(self, "jacobian", self._jacobian)

    def start(self) -> tuple[Array, float]:
        """(a, 1)."""
        return self.a.copy(), 1.0

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
