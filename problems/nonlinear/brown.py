"""Brown's almost linear function."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import expect
from continuation.arrays import Array
from problems.bibliography import BROWN
from problems.options import positive_integer, quiet


@frozen
class BrownAlmostLinear:
    """F_1 = prod_j x_j - 1, F_k = x_k + sum_j x_j - (n + 1) for k = 2..n; F(1, ..., 1) = 0.

    Parameters
    ----------
    n : int

    References
    ----------
    Brown, SIAM J. Numer. Anal. 6, 1969.
    """

    n: int = field(validator=positive_integer)
    references: ClassVar[tuple[str, ...]] = (BROWN,)

    @quiet
    def __call__(self, x: Array) -> Array:
        """The value."""
        expect(x.shape == (self.n,), "x", f"shape {(self.n,)}", x.shape)
        return np.concatenate((np.prod(x, keepdims=True) - 1.0, x[1:] + np.sum(x) - (self.n + 1.0)))

    @quiet
    def jacobian(self, x: Array) -> Array:
        """F'(x), shape (n, n).

        Parameters
        ----------
        x : Array of shape (n,)
        """
        # Dividing prod x by x_k would fail at x_k = 0.
        before = np.cumprod(np.concatenate((np.ones(1), x[:-1])))
        after = np.cumprod(np.concatenate((np.ones(1), x[:0:-1])))[::-1]
        return np.concatenate(((before * after)[None, :], np.eye(self.n)[1:] + 1.0))


def brown(n: int) -> BrownAlmostLinear:
    """Brown's almost linear function; ``fixed_point(F, a, F.jacobian)`` is the usual path.

    Parameters
    ----------
    n : int
    """
    return BrownAlmostLinear(n)
