"""Krawczyk's test for homotopies that are quadratic in all unknowns and the parameter: exact in the tube's width.

H(p + d) = H(p) + H'(p) d + Q(d, d), so that the derivative needs no interval arithmetic, only bounds of rounding; and
along a cubic H is a polynomial of degree 6, H' one of degree 3. The preconditioner follows the path, its inverse's
series to second order: terms of third order are left. No tensor of third order is formed.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.certificate.cells import Slabs
from continuation.certificate.engine import Judged
from problems.lcp.quadratic.derivative import Derivative
from problems.lcp.quadratic.form import Quadratic
from problems.lcp.quadratic.polynomial import Polynomial

CACHED_NUMBERS = 200_000
"""Numbers of one array of matrices at a time, 1.6 MB: a few of them are to be in a cache of several."""


@frozen(eq=False)
class ByProducts:
    """The engine of quadratic homotopies.

    Attributes
    ----------
    form : Quadratic
    """

    form: Quadratic
    exact: ClassVar[bool] = True
    most: ClassVar[int] = 4

    def together(self, m: int) -> int:
        """See `Engine`."""
        return max(1, CACHED_NUMBERS // (m * m))

    def judge(self, slabs: Slabs, radius: Array) -> Judged:
        """As `Engine.judge`; valid for all radii."""
        with np.errstate(all="ignore"):
            return Polynomial.of(slabs, Derivative.of(self.form, slabs.cubic), radius)
