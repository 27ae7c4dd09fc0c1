"""Elimination of linearised pairs from H' to a core of order n + 1 or 2 n + 1."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.linear import BorderedSystem, SingularError, factor_bordered
from problems.lcp.homotopies.cores import CoreSystem, Pairs, second_eliminated
from problems.lcp.homotopies.rows import RowPairs
from problems.lcp.homotopies.sides import BoundPairs

if TYPE_CHECKING:
    from problems.lcp.homotopies.interior import System


@frozen(eq=False)
class Core:
    """The full bordered system, solved by its core."""

    way: OfPairs | OfRows
    border: Array
    core: BorderedSystem

    @classmethod
    def of(cls, way: OfPairs | OfRows, border: Array) -> Core:
        """Factor the core; raises `SingularError`."""
        with np.errstate(all="ignore"):
            column, known = way.forward(way.system.column)
            row = np.append(way.row(border[:-1]), border[-1] - float(border[:-1].dot(known)))
            return cls(way, border, factor_bordered(way.matrix(), column, row))

    @property
    def sign(self) -> int:
        """Sign of the bordered determinant."""
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
    """Elimination in (x, y) to order n + 1 by the better pivot of each pair."""

    system: System
    first: Pairs | BoundPairs

    @property
    def sign(self) -> int:
        """Sign of the eliminated determinant."""
        odd = self.system.of.blend.sign < 0 and self.system.of.n % 2 == 1
        return -self.first.sign if odd else self.first.sign

    def forward(self, r: Array) -> tuple[Array, Array]:
        """The core's right-hand side, and the unknowns for k = 0."""
        homotopy, n = self.system.of, self.system.of.n
        alpha, beta, gamma = homotopy.blend.slopes(self.system.lam)
        v, force, dy = self.first.known(r[n:])
        top = homotopy.blend.sign * r[:n] + gamma * force - alpha * homotopy.problem.A.dot(v) - beta * v
        return top, np.concatenate([v, dy])

    def backward(self, k: Array, r: Array) -> Array:
        """All unknowns."""
        return np.concatenate(self.first.of(k, r[k.size :]))

    def row(self, border: Array) -> Array:
        """Coefficients of k in border . y."""
        n = self.system.of.n
        return border[:n] * self.first.a + self.first.row(border[n:])

    def matrix(self) -> Matrix:
        """The core's matrix."""
        alpha, beta, gamma = self.system.of.blend.slopes(self.system.lam)
        return self.system.of.structure.scaled(alpha, self.first.a, beta * self.first.a - gamma * self.first.b)


def factor_pairs(system: System, border: Array) -> BorderedSystem:
    """The bordered system of a homotopy in (x, y).

    The larger of each pair x_i, y_i stays; without any y the core is alpha A + beta I + gamma diag(y/x), with bounds
    s/(x-l) + t/(u-x) for y/x. Raises `SingularError`.
    """
    _, _, y, gaps, _ = system.parts
    core = Core.of(OfPairs(system, system.of.sides.eliminated(y, gaps, True)), border)
    return CoreSystem(system.apply, border, system.sizes, None, lambda: core)


@frozen(eq=False)
class OfRows:
    """Elimination for the KKT homotopy: to order n + 1, or without `second` to 2n + 1, keeping z2.

    The first core is symmetric, ``(1-lam) [A + A' + diag(z1/gap) + A' diag(D) A] + lam I``. D is z2/w for one bound,
    1/(s/z2 + t/(u-l-z2)) in a box, the inverse relaxation without bounds. The second does not square A.
    """

    system: System
    first: Pairs | BoundPairs
    pairs: RowPairs
    second: Pairs | None = None

    @property
    def sign(self) -> int:
        """Sign of the eliminated determinant."""
        return self.first.sign * self.pairs.sign * (1 if self.second is None else self.second.sign)

    def forward(self, r: Array) -> tuple[Array, Array]:
        """See `OfPairs`."""
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
        """Coefficients of k in border . y."""
        bx, b1, b2, b3 = self.pairs.rows.split(border)
        outer, inner = bx * self.first.a + self.first.row(b1), self.pairs.row(b2, b3)
        if self.second is None:
            return np.concatenate([outer, inner])
        row: Array = outer + self.system.of.structure.transpose.dot(self.second.b * inner)
        return row

    def matrix(self) -> Matrix:
        """The core's matrix."""
        structure, first, pairs, lam = self.system.of.structure, self.first, self.pairs, self.system.lam
        mu = 1.0 - lam
        if self.second is None:
            return structure.augmented(mu, lam, first.a, -mu * first.b, pairs.factor, pairs.rest, pairs.turn)
        weights = -self.second.b if pairs.turn is None else -pairs.turn * self.second.b
        return structure.normal(mu, weights, lam - mu * first.b)


def factor_rows(system: System, border: Array) -> BorderedSystem:
    """The KKT homotopy's bordered system; see `factor_pairs`."""
    homotopy, (_, _, p, q, _) = system.of, system.parts
    rows, structure, n, m = homotopy.rows, homotopy.structure, homotopy.n, homotopy.rows.sides.index.size
    z1, gap, factor, rest = p[:m], q[:m], p[m : m + n], q[m : m + n]
    if not structure.problem.standard:
        # Unbounded rows: dw + lam give dz2.
        factor, rest = np.where(rows.free, 1.0, factor), np.where(rows.free, system.lam * homotopy.give, rest)
    pairs = RowPairs.of_boxes(rows, factor, rest, p[m + n :], q[m + n :])

    def reduced() -> Core:
        second = second_eliminated(pairs.factor, pairs.rest)
        way = OfRows(system, rows.sides.eliminated(z1, gap, False), pairs, second)
        return Core.of(way, border)

    def augmented() -> Core:
        return Core.of(OfRows(system, rows.sides.eliminated(z1, gap, True), pairs), border)

    quick = None
    if structure.squarable:
        with suppress(SingularError):
            quick = reduced()
    if quick is not None and not homotopy.refine:
        return quick
    found = CoreSystem(system.apply, border, system.sizes, quick, augmented)
    if quick is None:
        _ = found.robust
    return found
