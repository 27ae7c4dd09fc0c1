"""Solves the full linear system by a smaller core.

The core is left when one unknown of each pair ``s v + x p = r`` (from x_i y_i = lambda c_i) is eliminated.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.linear import BorderedSystem, SingularError
from continuation.linear.silence import without_warnings

GAINED = 1e-3
"""Largest relative first correction of an accepted core: four corrections then reach round-off."""

_silently = without_warnings(all="ignore")
"""A pair of zeros gives inf, which the factorisation reports."""


def in_full(apply: Callable[[Array], Array], size: int, sparse: bool) -> tuple[Matrix, Array]:
    """(H_y, H_lam) from products of H' with unit vectors."""
    columns = [apply(np.eye(1, size + 1, k)[0]) for k in range(size + 1)]
    if sparse:
        return sp.csr_array(sp.hstack([sp.csc_array(column[:, None]) for column in columns[:-1]])), columns[-1]
    return np.column_stack(columns[:-1]), columns[-1]


@frozen(eq=False)
class Pairs:
    """Pairs ``s v + x p = r`` as ``v = a k + e r``, ``p = b k + f r``, where k is v (e = 0) or p (f = 0)."""

    a: Array
    b: Array
    e: Array
    f: Array
    sign: int
    """Sign of the eliminated determinant."""

    def known(self, r: Array) -> tuple[Array, Array, Array]:
        """The solution for k = 0: v, what p adds to the rows, and p."""
        p = self.f * r
        return self.e * r, p, p

    def row(self, border: Array) -> Array:
        """Coefficients of k in border . p."""
        return border * self.b

    def of(self, k: Array, r: Array) -> tuple[Array, Array]:
        """The pair (v, p)."""
        return self.a * k + self.e * r, self.b * k + self.f * r


@_silently
def second_eliminated(s: Array, x: Array) -> Pairs:
    """Eliminate every p, which keeps the core symmetric."""
    f = 1.0 / x
    return Pairs(np.ones_like(x), -s * f, np.zeros_like(x), f, parity(np.count_nonzero(x < 0.0)))


@_silently
def larger_eliminated(s: Array, x: Array) -> Pairs:
    """Eliminate the unknown with the larger coefficient: nothing cancels."""
    swapped = np.abs(x) < np.abs(s)
    pivot = np.where(swapped, s, x)
    inverse = 1.0 / pivot
    ratio = np.where(swapped, x, s) * -inverse
    ones, zeros = np.ones_like(x), np.zeros_like(x)
    # Each exchange swaps two columns.
    sign = parity(np.count_nonzero(pivot < 0.0) + np.count_nonzero(swapped))
    return Pairs(
        np.where(swapped, ratio, ones),
        np.where(swapped, ones, ratio),
        np.where(swapped, inverse, zeros),
        np.where(swapped, zeros, inverse),
        sign,
    )


def parity(count: int | np.intp) -> int:
    """1 for an even count, else -1."""
    return -1 if count % 2 else 1


@frozen(eq=False, slots=False)
class CoreSystem:
    """A bordered system solved by a quick or a robust core.

    `apply` maps z to H' z; `sizes` are the scales of unknowns, shape (N,). The quick core, smaller and symmetric, loses
    digits near zero pairs; the tangent's corrections decide which core serves.
    """

    apply: Callable[[Array], Array]
    border: Array
    sizes: Array
    quick: BorderedSystem | None
    make_robust: Callable[[], BorderedSystem]

    @cached_property
    def units(self) -> Array:
        """Scales; 1 for zeros and the parameter."""
        return np.append(np.where(self.sizes == 0.0, 1.0, self.sizes), 1.0)

    @cached_property
    def robust(self) -> BorderedSystem:
        """The core that pivots for stability."""
        return self.make_robust()

    @cached_property
    def sign(self) -> int:
        """Sign of the bordered determinant."""
        return self._probe[0].sign

    def solve(self, r: Array, rho: float) -> Array:
        """The solution, shape (N + 1,)."""
        core, tangent = self._probe
        if rho == 1.0 and not r.any():
            return tangent.copy()
        solution = None if core is not self.quick else self._refined(core, r, rho)
        return self._robustly(r, rho) if solution is None else solution

    def approximate(self, r: Array, rho: float) -> Array:
        """The uncorrected solution."""
        return self._probe[0].solve(r, rho)

    @cached_property
    def _probe(self) -> tuple[BorderedSystem, Array]:
        nothing = np.zeros(self.sizes.size)
        solution = None if self.quick is None else self._refined(self.quick, nothing, 1.0)
        if self.quick is None or solution is None:
            return self.robust, self._robustly(nothing, 1.0)
        return self.quick, solution

    def _residual(self, z: Array, r: Array, rho: float) -> tuple[Array, float]:
        return r - self.apply(z), rho - float(self.border.dot(z))

    def _robustly(self, r: Array, rho: float) -> Array:
        z = self.robust.solve(r, rho)
        return z + self.robust.solve(*self._residual(z, r, rho))

    @_silently
    def _refined(self, core: BorderedSystem, r: Array, rho: float) -> Array | None:
        """The solution to round-off; None if corrections are large."""
        try:
            z, last = core.solve(r, rho), np.inf
            # Four corrections, or one below 1e-9, reach round-off.
            for _ in range(4):
                correction = core.solve(*self._residual(z, r, rho))
                z = z + correction
                moved, overall = self._moved(correction, z)
                if not overall <= GAINED:
                    return None
                if moved <= GAINED**3 or moved > 0.5 * last:
                    break
                last = moved
        except SingularError:
            return None
        return z

    def _moved(self, correction: Array, z: Array) -> tuple[float, float]:
        """The relative corrections, by component and overall; tiny components count as 1e-6 of the largest."""
        units = self.units
        size = float(np.abs(z / units).max())
        if size == 0.0:
            return 0.0, 0.0
        relative = np.abs(correction) / (np.abs(z) + (GAINED**2 * size) * units)
        return float(relative.max()), float(np.abs(correction / units).max()) / size
