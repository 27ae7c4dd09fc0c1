"""From H' to its core of order n + 1, or 2 n + 1, and back: the linearised pairs are solved for one unknown each.

Eliminating is linear in the right-hand side, and the parameter's column is one: with `forward` from right-hand sides to
those of the core, and `backward` from the core's unknowns k to all, the core of ``[[H_y, H_lam], [border]]`` has the
column ``forward(H_lam)``, and what k leaves of z = (y, l) is ``backward(k, r - H_lam l)``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.linear import BorderedSystem, SingularError, Symmetric, factor_bordered
from problems.lcp.homotopies.cores import CoreSystem, Pairs, second_eliminated
from problems.lcp.homotopies.rows import RowPairs
from problems.lcp.homotopies.sides import BoundPairs

if TYPE_CHECKING:
    from problems.lcp.homotopies.interior import System

LEAST_GIVE = 1e-9
"""How far a row with bounds gives way at least to its multiplier in the core of order n + 1, in natural units.

At lambda = 0 a row that is active does not, and could not be eliminated. What this adds, and what is lost to rounding,
1e-7, the corrections in the full system take away.
"""

LEAST_GAP = 1e-13
"""The same for x and the multiplier of its bound, which is on the diagonal and takes no digits from others. On 90 paths
without the finish (n = 6, 12, 30), 2,300 systems, 147 had the robust core without it, 11 have it; 26 with 1e-16."""


@frozen(eq=False)
class Core:
    """The full bordered system by way of its core."""

    way: OfPairs | OfRows
    border: Array
    core: BorderedSystem

    @classmethod
    def of(cls, way: OfPairs | OfRows, border: Array, definite: bool = False) -> Core:
        """Factor the core; raises `SingularError` if that has no factorisation."""
        with np.errstate(all="ignore"):
            column, known = way.forward(way.system.column)
            row = np.append(way.row(border[:-1]), border[-1] - float(border[:-1].dot(known)))
            matrix = Symmetric(way.matrix(), definite=True) if definite else way.matrix()
            return cls(way, border, factor_bordered(matrix, column, row))

    @property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix."""
        return self.way.sign * self.core.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The full solution."""
        top, known = self.way.forward(r)
        k = self.core.solve(top, rho - float(self.border[:-1].dot(known)))
        z = np.empty(r.size + 1)
        z[-1] = k[-1]
        z[:-1] = self.way.backward(k[:-1], r - self.way.system.column * k[-1])
        return z


@frozen(eq=False)
class OfPairs:
    """Order n + 1, of the homotopies in (x, y): of each pair the better pivot eliminated, or y.

    The matrix is alpha A diag(a) + a diagonal, symmetric with A where all y are eliminated.
    """

    system: System
    larger: bool
    first: Pairs | BoundPairs

    @property
    def sign(self) -> int:
        """Of the determinant of what is eliminated; the core's first n rows are those in the brackets of `Blend`."""
        odd = self.system.of.blend.sign < 0 and self.system.of.n % 2 == 1
        return -self.first.sign if odd else self.first.sign

    def forward(self, r: Array) -> tuple[Array, Array]:
        """The core's right-hand side, and the unknowns that go with k = 0."""
        homotopy, n = self.system.of, self.system.of.n
        alpha, beta, gamma = homotopy.blend.slopes(self.system.lam)
        v, force, dy = self.first.known(r[n:])
        top = homotopy.blend.sign * r[:n] + gamma * force
        if self.larger:
            top -= alpha * homotopy.problem.A.dot(v) + beta * v
        return top, np.concatenate([v, dy])

    def backward(self, k: Array, r: Array) -> Array:
        """All unknowns."""
        return np.concatenate(self.first.of(k, r[k.size :]))

    def row(self, border: Array) -> Array:
        """The coefficients of k in border . y."""
        n = self.system.of.n
        return border[:n] * self.first.a + self.first.row(border[n:])

    def matrix(self) -> Matrix:
        """That of the core."""
        alpha, beta, gamma = self.system.of.blend.slopes(self.system.lam)
        return self.system.of.structure.scaled(alpha, self.first.a, beta * self.first.a - gamma * self.first.b)


def factor_pairs(system: System, border: Array) -> BorderedSystem:
    """The bordered system of a homotopy in (x, y), of order 2n + 1 for an LCP, from a factorisation of order n + 1.

    With y eliminated the core is alpha A + beta I + gamma diag(y/x), with s/(x-l) + t/(u-x) for y/x: Cholesky if A is
    symmetric positive semidefinite and alpha, beta, gamma >= 0. Else of each index the unknown with the larger
    coefficient is kept, for LU. Without `refine` solutions are those of the definite core, where there is one. Raises
    `SingularError` if no core has a factorisation.
    """
    homotopy, (_, _, y, gaps, _) = system.of, system.parts
    structure = homotopy.structure

    def core(larger: bool) -> Core:
        return Core.of(OfPairs(system, larger, homotopy.sides.eliminated(y, gaps, larger)), border, definite=not larger)

    definite = not (structure.problem.sparse or np.any(np.less(homotopy.blend.x, 0)))
    definite = definite and structure.symmetric and structure.semidefinite
    inside = definite and (gaps > 0.0).all() and (y > 0.0).all() and 0.0 <= system.lam <= 1.0
    return _refining(system, border, _or_none(lambda: core(False)) if inside else None, lambda: core(True), np.zeros(0))


@frozen(eq=False)
class OfRows:
    """Of the KKT homotopy: order n + 1, all multipliers eliminated; without `second` 2n + 1, z2 is kept.

    The first leaves a symmetric matrix for dx, ``(1 - lam) [A + A' + diag(z1/gap) + A' diag(D) A] + lam I``, where
    D = z2/w for a row with one bound, 1/(s/z2 + t/(u - l - z2)) in a box, and the inverse of what gives way where there
    is no bound. The other squares nothing, and eliminates of each distance and its force the better pivot.
    """

    system: System
    first: Pairs | BoundPairs
    pairs: RowPairs
    second: Pairs | None = None

    @property
    def sign(self) -> int:
        """Of the determinant of what is eliminated."""
        return self.first.sign * self.pairs.sign * (1 if self.second is None else self.second.sign)

    def forward(self, r: Array) -> tuple[Array, Array]:
        """The core's right-hand side, and the unknowns that go with k = 0."""
        structure, mu = self.system.of.structure, 1.0 - self.system.lam
        r1, r2, r3, r4 = self.pairs.rows.split(r)
        v, force, d1 = self.first.known(r2)
        top, right = r1 + mu * force, self.pairs.right(r3, r4)
        if self.second is None:
            top -= mu * structure.symmetrized.dot(v) + self.system.lam * v
            right = right - self.pairs.factor * structure.problem.A.dot(v)
        d2, d3 = self.pairs.of(np.zeros(v.size) if self.second is None else self.second.f * right, r4)
        top += mu * structure.transpose.dot(d2)
        return top if self.second is not None else np.concatenate([top, right]), np.concatenate([v, d1, d2, d3])

    def backward(self, k: Array, r: Array) -> Array:
        """All unknowns."""
        n = self.system.of.n
        _, r2, r3, r4 = self.pairs.rows.split(r)
        dx, d1 = self.first.of(k[:n], r2)
        inner = k[n:]
        if self.second is not None:
            _, inner = self.second.of(self.system.of.problem.A.dot(dx), self.pairs.right(r3, r4))
        return np.concatenate([dx, d1, *self.pairs.of(inner, r4)])

    def row(self, border: Array) -> Array:
        """The coefficients of k in border . y."""
        bx, b1, b2, b3 = self.pairs.rows.split(border)
        outer, inner = bx * self.first.a + self.first.row(b1), self.pairs.row(b2, b3)
        if self.second is None:
            return np.concatenate([outer, inner])
        row: Array = outer + self.system.of.structure.transpose.dot(self.second.b * inner)
        return row

    def matrix(self) -> Matrix:
        """That of the core."""
        structure, first, pairs, lam = self.system.of.structure, self.first, self.pairs, self.system.lam
        mu = 1.0 - lam
        if self.second is None:
            return structure.augmented(mu, lam, first.a, -mu * first.b, pairs.factor, pairs.rest, pairs.turn)
        weights = -self.second.b if pairs.turn is None else -pairs.turn * self.second.b
        return structure.normal(mu, weights, lam - mu * first.b)


def factor_rows(system: System, border: Array) -> BorderedSystem:
    """The bordered system of the KKT homotopy, from a factorisation of order n + 1, or 2n + 1 where that loses digits.

    Without `refine` solutions are those of the core of order n + 1, where there is one. Raises `SingularError` if no
    core has a factorisation.
    """
    homotopy, (_, _, p, q, _) = system.of, system.parts
    rows, structure, n, m = homotopy.rows, homotopy.structure, homotopy.n, homotopy.rows.sides.index.size
    z1, gap, factor, rest = p[:m], q[:m], p[m : m + n], q[m : m + n]
    if not structure.problem.standard:
        # Without bounds dw + lam give dz2.
        factor, rest = np.where(rows.free, 1.0, factor), np.where(rows.free, system.lam * homotopy.give, rest)
    pairs = RowPairs.of_boxes(rows, factor, rest, p[m + n :], q[m + n :])

    def reduced() -> Core:
        rest, distances = pairs.rest, gap
        if not structure.problem.standard:
            least = LEAST_GIVE * homotopy.unit * pairs.factor
            rest = np.where(np.abs(rest) < np.abs(least), least, rest)
            distances = np.maximum(gap, LEAST_GAP * z1 / homotopy.unit)
        way = OfRows(system, rows.sides.eliminated(z1, distances, False), pairs, second_eliminated(pairs.factor, rest))
        return Core.of(way, border, definite=structure.semidefinite and not structure.problem.sparse)

    def augmented() -> Core:
        return Core.of(OfRows(system, rows.sides.eliminated(z1, gap, True), pairs), border)

    return _refining(system, border, _or_none(reduced) if structure.squarable else None, augmented, rest)


def _or_none(make: Callable[[], Core]) -> Core | None:
    """A core; None where a pair is so near zero that it does not exist, or is singular."""
    try:
        return make()
    except SingularError:
        return None


def _refining(
    system: System, border: Array, quick: Core | None, robust: Callable[[], Core], coefficients: Array
) -> BorderedSystem:
    """The system to solve with: the quick core alone, or both, corrected; without `refine` the quick core as it is.

    Raises `SingularError` if there is no quick core and the robust one has no factorisation: said here, not at the
    first solve.
    """
    if quick is not None and not system.of.refine:
        return quick
    found = CoreSystem(system.apply, border, system.sizes, coefficients, quick, robust)
    if quick is None:
        _ = found.robust
    return found
