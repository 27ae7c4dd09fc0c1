"""The linearisation of the KKT homotopy: reduced to n + 1 equations, or to 2n + 1 where that loses digits."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem, SingularError, Symmetric, factor_bordered
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.homotopies.cores import Full, Pairs, core_system, second_eliminated
from problems.lcp.homotopies.rows import RowPairs, Rows, row_pairs
from problems.lcp.homotopies.sides import BoundPairs

LEAST_GIVE = 1e-9
"""How far a row with bounds gives way at least to its multiplier in the core of order n + 1, in natural units.

At lambda = 0 a row that is active does not, and could not be eliminated. What this adds, and what is lost to rounding,
1e-7, the corrections in the full system take away.
"""

LEAST_GAP = 1e-13
"""The same for x and the multiplier of its bound, which is on the diagonal and takes no digits from others. On 90 paths
without the finish (n = 6, 12, 30), 2,300 systems, 147 had the robust core without it, 11 have it; 26 with 1e-16."""


@frozen(eq=False)
class KKTSystem:
    """H' of the KKT homotopy at a point.

    `structure`: Of A. `gap`, `z1`, `c1`: The distances of x from its bounds, the multipliers of these, and their
    products at the start. `factor`, `rest`, `c2`: Of the rows ``factor (dw + dt) + rest dz2 - c2 l`` with w = A x + q +
    lam rho; for an LCP z2, w and the products at the start. Of shape (n,), as all that follow but the next. `z2`: The
    multipliers of the rows. `t`, `c3`: In boxes what w is below its positive part, and the products at the start.
    `rho`: The part of w that fades. `column`: dH1/dlam. `sizes`: In what changes of x and z2 are large or small.
    `give`: A unit of w for one of x.
    """

    structure: Structure
    rows: Rows
    lam: float
    gap: Array
    z1: Array
    c1: Array
    factor: Array
    rest: Array
    c2: Array
    z2: Array
    t: Array
    c3: Array
    rho: Array
    column: Array
    sizes: tuple[Array, Array]
    give: float

    def apply(self, v: Array) -> Array:
        """H' v, one shorter than v: two products with A."""
        rows, sides, mu, l = self.rows, self.rows.sides, 1.0 - self.lam, v[-1]
        dx, d1, d2, d3 = rows.split(v[:-1])
        # `dot`: for a few unknowns `@` of numpy takes four times as long.
        slope = self.structure.problem.A.dot(dx)
        image = np.empty(v.size - 1)
        first, forces, second, third = rows.split(image)
        pull = slope + self.structure.transpose.dot(dx - d2) - sides.force(d1)
        first[:] = mu * pull + self.lam * dx + self.column * l
        forces[:] = self.z1 * sides.pull(dx) + self.gap * d1 - self.c1 * l
        second[:] = self.factor * rows.raised(slope + self.rho * l, d3) + self.rest * d2 - self.c2 * l
        if third.size:
            boxed = rows.boxed
            third[:] = (rows.width - self.z2[boxed]) * d3 - self.t * d2[boxed] - self.c3 * l
        return image

    def hessian(self, v: Array) -> Array:
        """``((1 - lam) (A + A') + lam I) v``, dH1/dx applied to v."""
        product: Array = (1.0 - self.lam) * self.structure.symmetrized.dot(v) + self.lam * v
        return product

    def pairs(self) -> RowPairs:
        """The rows, once those of boxes are solved."""
        return row_pairs(self.rows, self.factor, self.rest, self.c2, self.z2, self.t, self.c3)


@frozen(eq=False)
class Reduced:
    """Order n + 1: all multipliers eliminated, which leaves a symmetric matrix for dx.

    ``G = (1 - lam) [A + A' + diag(z1/gap) + A' diag(D) A] + lam I``, where D = z2/w for a row with one bound,
    1/(s/z2 + t/(u - l - z2)) in a box, and the inverse of what gives way where there is no bound.
    """

    system: KKTSystem
    first: Pairs | BoundPairs
    pairs: RowPairs
    second: Pairs
    border: Array
    core: BorderedSystem

    @property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix."""
        return self.first.sign * self.pairs.sign * self.second.sign * self.core.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The full solution."""
        s, pairs, rows = self.system, self.pairs, self.system.rows
        mu, n = 1.0 - s.lam, s.column.size
        r1, r2, r3, r4 = rows.split(r)
        _, b1, b2, b3 = rows.split(self.border)
        known = pairs.right(r3, r4)
        _, force, d1 = self.first.known(r2)
        d2, d3 = pairs.of(self.second.f * known, r4, 0.0)
        top = r1 + mu * (force + s.structure.transpose.dot(d2))
        rest = rho - b1.dot(d1) - b2.dot(d2)
        k = self.core.solve(top, rest - b3[:-1].dot(d3) if d3.size else rest)
        z = np.empty(r.size + 1)
        dx, forces, second, third = rows.split(z[:-1])
        dx[:], z[-1] = k[:n], k[n]
        forces[:] = self.first.partner(k[:n], r2, k[n])
        inner = self.second.partner(s.structure.problem.A.dot(k[:n]) + s.rho * k[n], known, k[n])
        second[:], third[:] = pairs.of(inner, r4, k[n])
        return z


@frozen(eq=False)
class Augmented:
    """Order 2n + 1: of each distance and its force the better pivot eliminated, z2 kept; nothing is squared."""

    system: KKTSystem
    first: Pairs | BoundPairs
    pairs: RowPairs
    border: Array
    core: BorderedSystem

    @property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix."""
        return self.first.sign * self.pairs.sign * self.core.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The full solution."""
        s, pairs, rows, n = self.system, self.pairs, self.system.rows, self.system.column.size
        mu = 1.0 - s.lam
        r1, r2, r3, r4 = rows.split(r)
        bx, b1, b2, b3 = rows.split(self.border[:-1])
        v, force, d1 = self.first.known(r2)
        top = r1 - s.hessian(v) + mu * force
        bottom = pairs.right(r3, r4) - s.factor * (s.structure.problem.A @ v)
        known = float(bx @ v) + float(b1 @ d1)
        if r4.size:
            d2, d3 = pairs.of(np.zeros(n), r4, 0.0)
            top = top + mu * (s.structure.transpose @ d2)
            known += float(b2 @ d2) + float(b3 @ d3)
        k = self.core.solve(np.concatenate([top, bottom]), rho - known)
        z = np.empty(r.size + 1)
        dx, forces, second, third = rows.split(z[:-1])
        dx[:], forces[:] = self.first.of(k[:n], r2, k[-1])
        second[:], third[:] = pairs.of(k[n:-1], r4, k[-1])
        z[-1] = k[-1]
        return z


def factor_kkt(system: KKTSystem, border: Array, refine: bool = True) -> BorderedSystem:
    """The bordered system at a point, of order 3n + 1 for an LCP, from a factorisation of order n + 1 (or 2n + 1).

    Without `refine` solutions are those of the core of order n + 1, where there is one. Raises `SingularError` if no
    core has a factorisation.
    """
    x, z2 = system.sizes
    full = Full(system.apply, border, (x, system.z1, z2, system.t), (system.rest,))
    quick = _reduced(system, border) if system.structure.squarable else None
    return core_system(full, quick, lambda: _augmented(system, border), refine)


def _reduced(system: KKTSystem, border: Array) -> Reduced | None:
    """The reduced form; None where a pair is so near zero that it does not exist, or is singular."""
    s, n, mu = system, system.column.size, 1.0 - system.lam
    transpose = s.structure.transpose
    with np.errstate(all="ignore"):
        pairs, gap = s.pairs(), s.gap
        rest = pairs.rest
        if not s.structure.problem.standard:
            least = LEAST_GIVE * s.give * pairs.factor
            rest = np.where(np.abs(rest) < np.abs(least), least, rest)
            gap = np.maximum(gap, LEAST_GAP * s.z1 / s.give)
        first = s.rows.sides.eliminated(s.z1, gap, s.c1, larger=False)
        second = second_eliminated(pairs.factor, rest, pairs.c)
        d2, d3 = pairs.of(second.b * s.rho + second.f * pairs.c, np.zeros_like(s.c3), 1.0)
        _, force, d1 = first.known(s.c1)
        bx, b1, b2, b3 = s.rows.split(border[:-1])
        column = s.column - mu * (force + transpose.dot(d2))
        row = np.empty(n + 1)
        row[:n] = bx + first.row(b1) + transpose.dot(second.b * pairs.row(b2, b3))
        row[n] = border[-1] + float(b1.dot(d1)) + float(b2.dot(d2)) + float(b3.dot(d3))
        weights = -second.b if pairs.turn is None else -pairs.turn * second.b
        try:
            matrix = s.structure.normal(mu, weights, s.lam - mu * first.b)
            definite = s.structure.semidefinite and not s.structure.problem.sparse
            core = factor_bordered(Symmetric(matrix, definite=True) if definite else matrix, column, row)
            return Reduced(s, first, pairs, second, border, core)
        except SingularError:
            return None


def _augmented(system: KKTSystem, border: Array) -> Augmented:
    s, n, mu = system, system.column.size, 1.0 - system.lam
    with np.errstate(all="ignore"):
        first, pairs = s.rows.sides.eliminated(s.z1, s.gap, s.c1, larger=True), s.pairs()
        v, force, d1 = first.known(s.c1)
        top = s.column + s.hessian(v) - mu * force
        bottom = s.factor * (s.rho + s.structure.problem.A @ v) - pairs.c
        bx, b1, b2, b3 = s.rows.split(border[:-1])
        corner = border[-1] + float(bx @ v) + float(b1 @ d1)
        if s.t.size:
            d2, d3 = pairs.of(np.zeros(n), np.zeros_like(s.c3), 1.0)
            top -= mu * (s.structure.transpose @ d2)
            corner += float(b2 @ d2) + float(b3 @ d3)
        row = np.concatenate([bx * first.a + first.row(b1), pairs.row(b2, b3), [corner]])
        matrix = s.structure.augmented(mu, s.lam, first.a, -mu * first.b, s.factor, pairs.rest, pairs.turn)
        core = factor_bordered(matrix, np.concatenate([top, bottom]), row)
        return Augmented(s, first, pairs, border, core)
