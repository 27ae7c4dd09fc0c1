"""What a factored bordered matrix can do; every structure of `continuation.linear` is one of these."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from attrs import frozen

from continuation.arrays import Array


class SingularError(ArithmeticError):
    """The bordered matrix has no factorisation: it is singular to working precision, or not finite."""


class BorderedSystem(Protocol):
    """A factorisation of the bordered matrix ``[[H_y, H_lam], [border']]`` of order N + 1.

    A structure whose `solve` refines its answer may offer `approximate`, with the same arguments, which does not.
    """

    @property
    def sign(self) -> int:
        """Sign of the determinant, +1 or -1; 0 where the structure cannot tell (operators)."""
        ...

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, shape (N + 1,), of ``H_y dy + H_lam dlam = r`` and ``border . z = rho``.

        Parameters
        ----------
        r : ndarray, shape (N,)
        rho : float

        Returns
        -------
        ndarray, shape (N + 1,)
        """
        ...


@frozen(eq=False)
class Solver:
    """A matrix that is factored, or a bordered system that another one solves.

    `solve`: The solution for a right-hand side, or for that of a `BorderedSystem`. `tell_sign`: The sign of the
    determinant, worked out when it is asked for.
    """

    solve: Callable[..., Array]
    tell_sign: Callable[[], int]

    @property
    def sign(self) -> int:
        """Sign of the determinant."""
        return self.tell_sign()
