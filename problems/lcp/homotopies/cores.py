"""From the full system to its core: complementary pairs eliminated, the rest factored, the answer refined.

The homotopies of this package couple unknowns in pairs, ``s_i v_i + x_i p_i - c_i l = r_i`` (l is the increment of
lambda), which come from x_i y_i = lambda c_i. One unknown of each pair is eliminated; what is left is the core.
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
"""What a correction in the full system leaves of an error at least: a core whose first correction is larger, in the
units of the point, is not believed, and four of them reach round-off. Its powers are all other limits here."""

FIRM_CORRECTION = 1e-13
"""Relative size of the tangent's correction, round-off, below which the core's solutions are taken as they are."""


_silently = without_warnings(all="ignore")
"""A pair of zeros gives an inf here, which the factorisation of the core then reports."""


def in_full(apply: Callable[[Array], Array], size: int, sparse: bool) -> tuple[Matrix, Array]:
    """(H_y, H_lam) from the products of H' with unit vectors: for what needs a matrix, as a singular point does."""
    columns = [apply(np.eye(1, size + 1, k)[0]) for k in range(size + 1)]
    if sparse:
        return sp.csr_array(sp.hstack([sp.csc_array(column[:, None]) for column in columns[:-1]])), columns[-1]
    return np.column_stack(columns[:-1]), columns[-1]


@frozen(eq=False)
class Pairs:
    """The pairs ``s v + x p = r`` solved for one unknown each: ``v = a k + e r`` and ``p = b k + f r``.

    k is the unknown kept: v where p is eliminated, so that e = 0, and p where v is, so that f = 0.
    """

    a: Array
    b: Array
    e: Array
    f: Array
    sign: int
    """Sign of the determinant of the eliminated part: that of the whole is this times the core's."""

    def known(self, r: Array) -> tuple[Array, Array, Array]:
        """What right-hand sides add: to v, to p as it stands in other rows, and to p."""
        p = self.f * r
        return self.e * r, p, p

    def row(self, border: Array) -> Array:
        """The coefficients of k in border . p."""
        return border * self.b

    def of(self, k: Array, r: Array) -> tuple[Array, Array]:
        """The pair (v, p)."""
        return self.a * k + self.e * r, self.b * k + self.f * r


@_silently
def second_eliminated(s: Array, x: Array) -> Pairs:
    """Eliminate every p of the pairs ``s v + x p = r``: what is left keeps the symmetry of the core."""
    f = 1.0 / x
    return Pairs(np.ones_like(x), -s * f, np.zeros_like(x), f, parity(np.count_nonzero(x < 0.0)))


@_silently
def larger_eliminated(s: Array, x: Array) -> Pairs:
    """Eliminate of ``s v + x p = r`` the unknown with the larger coefficient.

    There is no cancellation, and either coefficient may be zero.
    """
    swapped = np.abs(x) < np.abs(s)
    pivot = np.where(swapped, s, x)
    inverse = 1.0 / pivot
    ratio = np.where(swapped, x, s) * -inverse
    ones, zeros = np.ones_like(x), np.zeros_like(x)
    # Each exchange of a v with its p is one exchange of columns.
    sign = parity(np.count_nonzero(pivot < 0.0) + np.count_nonzero(swapped))
    return Pairs(
        np.where(swapped, ratio, ones),
        np.where(swapped, ones, ratio),
        np.where(swapped, inverse, zeros),
        np.where(swapped, zeros, inverse),
        sign,
    )


def parity(count: int | np.intp) -> int:
    """1 for an even number of changes of sign, else -1."""
    return -1 if count % 2 else 1


@frozen(eq=False, slots=False)
class CoreSystem:
    """A bordered system solved by its quick core and corrected in full, by its robust core where that fails.

    The full system is known by its products: `apply` takes z to H' z, ``(N + 1,) -> (N,)``. `sizes`, of shape (N,): In
    what the unknowns are large or small. `coefficients`: More of what stands in the pairs.

    The quick core is smaller and symmetric, and loses digits as a pair approaches zero; corrections regain them. The
    first solve is for the tangent, which the engine wants anyway: its corrections tell which core serves, and whether
    its solutions are at round-off as they are, as they are far from the boundary.
    """

    apply: Callable[[Array], Array]
    border: Array
    sizes: Array
    coefficients: Array
    quick: BorderedSystem | None
    make_robust: Callable[[], BorderedSystem]

    @cached_property
    def units(self) -> Array:
        """Sizes of the unknowns, one for a zero and for the parameter."""
        return np.append(np.where(self.sizes == 0.0, 1.0, self.sizes), 1.0)

    @cached_property
    def robust(self) -> BorderedSystem:
        """The core that pivots for stability."""
        return self.make_robust()

    @cached_property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix."""
        return self._probe[0].sign

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, shape (N + 1,)."""
        core, tangent, firm = self._probe
        if rho == 1.0 and not r.any():
            return tangent.copy()
        if firm:
            return core.solve(r, rho)
        solution = self._refined(core, r, rho)
        return self._robustly(r, rho)[0] if solution is None else solution[0]

    def approximate(self, r: Array, rho: float) -> Array:
        """The solution by the core as it is: for an iteration that measures its own residual."""
        return self._probe[0].solve(r, rho)

    @cached_property
    def _probe(self) -> tuple[BorderedSystem, Array, bool]:
        """The core to be used, its tangent (the solution for (0, 1)), and whether its solutions need no correction."""
        nothing = np.zeros(self.sizes.size)
        solution = None if self.quick is None else self._refined(self.quick, nothing, 1.0)
        core = self.robust if self.quick is None or solution is None else self.quick
        tangent, moved = self._robustly(nothing, 1.0) if solution is None else solution
        return core, tangent, moved <= FIRM_CORRECTION and self._even()

    @_silently
    def _even(self) -> bool:
        """Whether all factors of the pairs are of like sizes: then the tangent's correction speaks for others."""
        sizes = np.abs(np.concatenate([self.sizes, self.coefficients, [1.0]]))
        return bool(GAINED * sizes.max() <= sizes.min())

    def _residual(self, z: Array, r: Array, rho: float) -> tuple[Array, float]:
        """``(r, rho) - M z``."""
        return r - self.apply(z), rho - float(self.border.dot(z))

    def _robustly(self, r: Array, rho: float) -> tuple[Array, float]:
        """The solution by the robust core, corrected once whatever that does, and the size of the correction."""
        z = self.robust.solve(r, rho)
        correction = self.robust.solve(*self._residual(z, r, rho))
        return z + correction, self._moved(correction, z)[0]

    @_silently
    def _refined(self, core: BorderedSystem, r: Array, rho: float) -> tuple[Array, float] | None:
        """The solution at round-off, and the size of its first correction; None where that is large.

        Corrections shrink by the error of the core times the condition of the system, down to round-off times the
        condition: where they stall at a small size, the residual is as small as it can be.
        """
        try:
            z, changes = core.solve(r, rho), [np.inf]
            # Another correction than the fourth, or than one of nine digits, would be below round-off.
            while len(changes) <= 4 and changes[-1] > GAINED**3:
                correction = core.solve(*self._residual(z, r, rho))
                z = z + correction
                moved, overall = self._moved(correction, z)
                if not overall <= GAINED:
                    return None
                changes.append(moved)
                if moved > 0.5 * changes[-2]:
                    break
        except SingularError:
            return None
        return z, changes[1]

    def _moved(self, correction: Array, z: Array) -> tuple[float, float]:
        """How much a correction changes z: component by component, and in the units of the point.

        What a component smaller than a millionth, in the units of the point, does to it is nothing to the step.
        """
        units = self.units
        size = float(np.abs(z / units).max())
        if size == 0.0:
            return 0.0, 0.0
        relative = np.abs(correction) / (np.abs(z) + (GAINED**2 * size) * units)
        return float(relative.max()), float(np.abs(correction / units).max()) / size
