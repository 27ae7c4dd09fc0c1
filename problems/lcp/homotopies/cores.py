"""From the full system to its core: complementary pairs eliminated, the rest factored, the answer refined.

The homotopies of this package couple unknowns in pairs, ``s_i v_i + x_i p_i - c_i l = r_i`` (l is the increment of
lambda), which come from x_i y_i = lambda c_i. One unknown of each pair is eliminated; what is left is the core.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np
import scipy.sparse as sp
from attrs import define, frozen

from continuation.arrays import Array, Matrix
from continuation.linear import BorderedSystem, SingularError
from continuation.linear.silence import without_warnings

CORE_REFINEMENTS = 4
"""Corrections in the full system that a solve may take; one is the rule, and each gains three digits (`UNRELIABLE`)."""

CONVERGED = 1e-9
"""Relative size of a correction, component by component, after which the next would be below 1e-12 (`UNRELIABLE`)."""

SMALL_COMPONENT = 1e-6
"""A component smaller than this, of the largest one in the units of the point, need not have relative accuracy.

What it does to the point is a millionth of what the step does.
"""

FIRM_CORRECTION = 1e-13
"""Relative size of the tangent's correction, round-off, below which the core's solutions are taken as they are."""

FIRM_SPREAD = 1e3
"""Ratio of the largest to the smallest factor of the pairs up to which the tangent's correction speaks for others."""

UNRELIABLE = 1e-3
"""Relative size of the first correction, in the units of the point, above which a core is not believed."""


System = TypeVar("System")

_silently = without_warnings(all="ignore")
"""A pair of zeros gives an inf here, which the factorisation of the core then reports."""


@define(eq=False)
class Recent(Generic[System]):
    """The system at the last point that was asked for: the engine asks for many products there, one by one."""

    found: tuple[bytes, float, System] | None = None

    def at(self, y: Array, lam: float, make: Callable[[Array, float], System]) -> System:
        """The system at a point, made of a copy of y."""
        found, entries = self.found, y.tobytes()
        if found is None or found[:2] != (entries, lam):
            self.found = found = entries, lam, make(y.copy(), lam)
        return found[2]


def in_full(apply: Callable[[Array], Array], size: int, sparse: bool) -> tuple[Matrix, Array]:
    """(H_y, H_lam) from the products of H' with unit vectors: for what needs a matrix, as a singular point does."""
    columns = [apply(np.eye(1, size + 1, k)[0]) for k in range(size + 1)]
    if sparse:
        return sp.csr_array(sp.hstack([sp.csc_array(column[:, None]) for column in columns[:-1]])), columns[-1]
    return np.column_stack(columns[:-1]), columns[-1]


@frozen(eq=False)
class Pairs:
    """The pairs ``s v + x p - c l = r`` solved for one unknown each.

    ``v = a k + e (r + c l)`` and ``p = b k + f (r + c l)``, where k is the unknown kept: v where p is eliminated, so
    that e = 0, and p where v is, so that f = 0.
    """

    a: Array
    b: Array
    e: Array
    f: Array
    c: Array
    sign: int
    """Sign of the determinant of the eliminated part: that of the whole is this times the core's."""

    def known(self, t: Array) -> tuple[Array, Array, Array]:
        """What right-hand sides t add: to v, to p as it stands in other rows, and to p."""
        p = self.f * t
        return self.e * t, p, p

    def row(self, border: Array) -> Array:
        """The coefficients of k in border . p."""
        return border * self.b

    def of(self, k: Array, r: Array, l: float) -> tuple[Array, Array]:
        """The pair (v, p)."""
        t = r + self.c * l
        return self.a * k + self.e * t, self.b * k + self.f * t

    def partner(self, k: Array, r: Array, l: float) -> Array:
        """P alone."""
        return self.b * k + self.f * (r + self.c * l)


@_silently
def second_eliminated(s: Array, x: Array, c: Array) -> Pairs:
    """Eliminate every p of the pairs ``s v + x p - c l = r``: what is left keeps the symmetry of the core."""
    f = 1.0 / x
    ones, zeros = np.ones_like(x), np.zeros_like(x)
    return Pairs(ones, -s * f, zeros, f, c, parity(np.count_nonzero(x < 0.0)))


@_silently
def larger_eliminated(s: Array, x: Array, c: Array) -> Pairs:
    """Eliminate of ``s v + x p - c l = r`` the unknown with the larger coefficient.

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
        c,
        sign,
    )


def parity(count: int | np.intp) -> int:
    """1 for an even number of changes of sign, else -1."""
    return -1 if count % 2 else 1


@frozen(eq=False, slots=False)
class Full:
    """The full bordered system, known by its products: `apply` takes z to H' z, ``(N + 1,) -> (N,)``.

    The point has the unknowns, block by block; the coefficients are more of what stands in the pairs.
    """

    apply: Callable[[Array], Array]
    border: Array
    point: tuple[Array, ...]
    coefficients: tuple[Array, ...] = ()

    @cached_property
    def units(self) -> Array:
        """Sizes of the unknowns, one for a zero and for the parameter, in which a correction is large or small."""
        sizes: Array = np.abs(np.concatenate([*self.point, [1.0]]))
        sizes[sizes == 0.0] = 1.0
        return sizes

    @cached_property
    def spread(self) -> float:
        """Ratio of the largest to the smallest coefficient in the pairs; inf if one is zero."""
        sizes = np.abs(np.concatenate([*self.point, *self.coefficients, [1.0]]))
        smallest = float(sizes.min())
        if smallest == 0.0:
            return np.inf
        with np.errstate(over="ignore"):
            return float(sizes.max()) / smallest

    def residual(self, z: Array, r: Array, rho: float) -> tuple[Array, float]:
        """``(r, rho) - M z``."""
        return r - self.apply(z), rho - float(self.border.dot(z))


@frozen(eq=False)
class TangentSolve:
    """The core to be used, its tangent (the solution for (0, 1)), and whether its solutions need no correction."""

    core: BorderedSystem
    tangent: Array
    firm: bool


@frozen(eq=False, slots=False)
class CoreSystem:
    """A bordered system solved by its quick core and corrected in full, by its robust core where that fails.

    The quick core is smaller and symmetric, and loses digits as a pair approaches zero; corrections regain them. The
    first solve is for the tangent, which the engine wants anyway: its corrections tell which core serves, and whether
    its solutions are at round-off as they are, as they are far from the boundary.
    """

    full: Full
    quick: BorderedSystem | None
    make_robust: Callable[[], BorderedSystem]

    @cached_property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix."""
        return self._probe.core.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, shape (N + 1,)."""
        probe = self._probe
        if rho == 1.0 and not r.any():
            return probe.tangent.copy()
        if probe.firm:
            return probe.core.solve(r, rho)
        solution = self._refined(probe.core, r, rho)
        return self._robustly(r, rho)[0] if solution is None else solution[0]

    def approximate(self, r: Array, rho: float) -> Array:
        """The solution by the core as it is: for an iteration that measures its own residual."""
        return self._probe.core.solve(r, rho)

    @cached_property
    def robust(self) -> BorderedSystem:
        """The core that pivots for stability."""
        return self.make_robust()

    @cached_property
    def _probe(self) -> TangentSolve:
        nothing = np.zeros(self.full.border.size - 1)
        solution = None if self.quick is None else self._refined(self.quick, nothing, 1.0)
        if self.quick is None or solution is None:
            tangent, moved = self._robustly(nothing, 1.0)
            return TangentSolve(self.robust, tangent, self._firm(moved))
        return TangentSolve(self.quick, solution[0], self._firm(solution[1]))

    def _firm(self, moved: float) -> bool:
        return moved <= FIRM_CORRECTION and self.full.spread <= FIRM_SPREAD

    def _robustly(self, r: Array, rho: float) -> tuple[Array, float]:
        """The solution by the robust core, corrected once whatever that does, and the size of the correction."""
        z = self.robust.solve(r, rho)
        correction = self.robust.solve(*self.full.residual(z, r, rho))
        return z + correction, self._moved(correction, z)[0]

    @_silently
    def _refined(self, core: BorderedSystem, r: Array, rho: float) -> tuple[Array, float] | None:
        """The solution at round-off, and the size of its first correction; None where that is large.

        Corrections shrink by the error of the core times the condition of the system, down to round-off times the
        condition: where they stall at a small size, the residual is as small as it can be.
        """
        try:
            z = core.solve(r, rho)
            changes: list[float] = []
            while len(changes) < CORE_REFINEMENTS:
                correction = core.solve(*self.full.residual(z, r, rho))
                z = z + correction
                moved, overall = self._moved(correction, z)
                if not overall <= UNRELIABLE:
                    return None
                stalled = bool(changes) and moved > 0.5 * changes[-1]
                changes.append(moved)
                if moved <= CONVERGED or stalled:
                    break
        except SingularError:
            return None
        return z, changes[0]

    def _moved(self, correction: Array, z: Array) -> tuple[float, float]:
        """How much a correction changes z: component by component, and in the units of the point."""
        units = self.full.units
        size = float(np.abs(z / units).max())
        if size == 0.0:
            return 0.0, 0.0
        relative = np.abs(correction) / (np.abs(z) + (SMALL_COMPONENT * size) * units)
        return float(relative.max()), float(np.abs(correction / units).max()) / size


def core_system(
    full: Full, quick: BorderedSystem | None, make_robust: Callable[[], BorderedSystem], refine: bool
) -> BorderedSystem:
    """The system to solve with: the quick core alone, or both, corrected; without `refine` the quick core as it is.

    Raises `SingularError` if there is no quick core and the robust one has no factorisation: said here, not at the
    first solve.
    """
    if quick is not None and not refine:
        return quick
    system = CoreSystem(full, quick, make_robust)
    if quick is None:
        _ = system.robust
    return system
