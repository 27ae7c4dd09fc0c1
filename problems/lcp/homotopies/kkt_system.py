"""The linearisation of the KKT homotopy: 3n + 1 equations, reduced to n + 1, or to 2n + 1 where that loses digits."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem, SingularError, Symmetric, factor_bordered
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.homotopies.cores import Full, Pairs, core_system, larger_eliminated, second_eliminated


@frozen(eq=False)
class KKTSystem:
    """H' of the KKT homotopy at a point.

    Attributes
    ----------
    structure : Structure
        Of A.
    lam : float
    x, z1, z2, w : Array
        The point, w = A x + q + lam rho; each of shape (n,), as all that follow.
    c1, c2, rho : Array
        The products z1 x and z2 w at the start, and the part of w that fades.
    column : Array
        dH1/dlam.
    """

    structure: Structure
    lam: float
    x: Array
    z1: Array
    z2: Array
    w: Array
    c1: Array
    c2: Array
    rho: Array
    column: Array

    def apply(self, v: Array) -> Array:
        """H' v, shape (3n,), for v of shape (3n + 1,): two products with A."""
        n, mu, l = self.x.size, 1.0 - self.lam, v[-1]
        dx, d1, d2 = v[:n], v[n : 2 * n], v[2 * n : -1]
        slope = self.structure.problem.A @ dx
        image = np.empty(3 * n)
        image[:n] = mu * (slope + self.structure.transpose @ (dx - d2) - d1) + self.lam * dx + self.column * l
        image[n : 2 * n] = self.z1 * dx + self.x * d1 - self.c1 * l
        image[2 * n :] = self.z2 * (slope + self.rho * l) + self.w * d2 - self.c2 * l
        return image

    def hessian(self, v: Array) -> Array:
        """``((1 - lam) (A + A') + lam I) v``, dH1/dx applied to v."""
        product: Array = (1.0 - self.lam) * (self.structure.symmetrized @ v) + self.lam * v
        return product


@frozen(eq=False)
class Reduced:
    """Order n + 1: both multipliers eliminated, which leaves a symmetric matrix for dx.

    ``G = (1 - lam) [A + A' + diag(z1/x) + A' diag(z2/w) A] + lam I``; det H' = det(core) prod(x) prod(w).
    """

    system: KKTSystem
    first: Pairs
    second: Pairs
    border: Array
    core: BorderedSystem

    @property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix."""
        return self.first.sign * self.second.sign * self.core.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The full solution, shape (3n + 1,)."""
        s, first, second = self.system, self.first, self.second
        n, mu = s.x.size, 1.0 - s.lam
        r2, r3 = r[n : 2 * n], r[2 * n :]
        t2, t3 = first.f * r2, second.f * r3
        top = r[:n] + mu * (t2 + s.structure.transpose @ t3)
        k = self.core.solve(top, rho - float(self.border[n : 2 * n] @ t2) - float(self.border[2 * n : -1] @ t3))
        z = np.empty(3 * n + 1)
        z[:n], z[-1] = k[:n], k[n]
        z[n : 2 * n] = first.of(k[:n], r2, k[n])[1]
        z[2 * n : -1] = second.of(s.structure.problem.A @ k[:n] + s.rho * k[n], r3, k[n])[1]
        return z


@frozen(eq=False)
class Augmented:
    """Order 2n + 1: of each pair (x_i, z1_i) the better pivot eliminated, z2 kept; nothing is squared."""

    system: KKTSystem
    pairs: Pairs
    border: Array
    core: BorderedSystem

    @property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix."""
        return self.pairs.sign * self.core.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The full solution, shape (3n + 1,)."""
        s, pairs, n = self.system, self.pairs, self.system.x.size
        r2 = r[n : 2 * n]
        v, p = pairs.e * r2, pairs.f * r2
        top = r[:n] - s.hessian(v) + (1.0 - s.lam) * p
        bottom = r[2 * n :] - s.z2 * (s.structure.problem.A @ v)
        known = float(self.border[:n] @ v) + float(self.border[n : 2 * n] @ p)
        k = self.core.solve(np.concatenate([top, bottom]), rho - known)
        z = np.empty(3 * n + 1)
        z[:n], z[n : 2 * n] = pairs.of(k[:n], r2, k[-1])
        z[2 * n :] = k[n:]
        return z


def factor_kkt(system: KKTSystem, border: Array, refine: bool = True) -> BorderedSystem:
    """The bordered system of order 3n + 1 at a point, from a factorisation of order n + 1 (or 2n + 1).

    Parameters
    ----------
    system : KKTSystem
    border : Array of shape (3n + 1,)
    refine : bool
        Whether solutions are corrected in full. Without it they are those of the core of order n + 1, where there is
        one.

    Raises
    ------
    SingularError
        If no core has a factorisation.
    """
    full = Full(system.apply, border, (system.x, system.z1, system.z2), (system.w,))
    quick = _reduced(system, border) if system.structure.squarable else None
    return core_system(full, quick, lambda: _augmented(system, border), refine)


def _reduced(system: KKTSystem, border: Array) -> Reduced | None:
    """The reduced form; None where a pair is so near zero that it does not exist, or is singular."""
    s, n, mu = system, system.x.size, 1.0 - system.lam
    transpose = s.structure.transpose
    with np.errstate(all="ignore"):
        first, second = second_eliminated(s.z1, s.x, s.c1), second_eliminated(s.z2, s.w, s.c2)
        fade = second.b * s.rho + second.f * s.c2
        b1, b2 = border[n : 2 * n], border[2 * n : -1]
        column = s.column - mu * (first.f * s.c1 + transpose @ fade)
        row = np.empty(n + 1)
        row[:n] = border[:n] + first.b * b1 + transpose @ (second.b * b2)
        row[n] = border[-1] + float(b1 @ (first.f * s.c1)) + float(b2 @ fade)
        try:
            matrix = s.structure.normal(mu, -second.b, s.lam - mu * first.b)
            if s.structure.semidefinite and not s.structure.problem.sparse:
                matrix = Symmetric(matrix, definite=True)
            return Reduced(s, first, second, border, factor_bordered(matrix, column, row))
        except SingularError:
            return None


def _augmented(system: KKTSystem, border: Array) -> Augmented:
    s, n, mu = system, system.x.size, 1.0 - system.lam
    with np.errstate(all="ignore"):
        pairs = larger_eliminated(s.z1, s.x, s.c1)
        v, p = pairs.e * s.c1, pairs.f * s.c1
        top = s.column + s.hessian(v) - mu * p
        bottom = s.z2 * (s.rho + s.structure.problem.A @ v) - s.c2
        bx, b1 = border[:n], border[n : 2 * n]
        corner = border[-1] + float(bx @ v) + float(b1 @ p)
        row = np.concatenate([bx * pairs.a + b1 * pairs.b, border[2 * n : -1], [corner]])
        matrix = s.structure.augmented(mu, s.lam, pairs.a, -mu * pairs.b, s.z2, s.w)
        return Augmented(s, pairs, border, factor_bordered(matrix, np.concatenate([top, bottom]), row))
