"""Krawczyk's test for quadratic homotopies, exact in the tube's width.

H(p + d) = H(p) + H'(p) d + Q(d, d), so only rounding needs bounds. The preconditioner is the inverse's second-order
series, so third-order terms remain.
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
"""Numbers in an array of matrices; a few such arrays fit in cache."""


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
        """See `Engine`; valid for all radii."""
        with np.errstate(all="ignore"):
            return Polynomial.of(slabs, Derivative.of(self.form, slabs.cubic), radius)
