"""The interface of factored bordered matrices."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from attrs import frozen

from continuation.arrays import Array


class SingularError(ArithmeticError):
    """The bordered matrix is singular to working precision or not finite."""


class BorderedSystem(Protocol):
    """A factorisation of ``[[H_y, H_lam], [border']]``, order N + 1.

    `approximate`, if present, solves without refinement.
    """

    @property
    def sign(self) -> int:
        """Sign of the determinant, +1 or -1; 0 if unknown (operators)."""
        ...

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z of ``H_y dy + H_lam dlam = r``, ``border . z = rho``.

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
    """A factored matrix or bordered system."""

    solve: Callable[..., Array]
    tell_sign: Callable[[], int]

    @property
    def sign(self) -> int:
        """Sign of the determinant."""
        return self.tell_sign()
