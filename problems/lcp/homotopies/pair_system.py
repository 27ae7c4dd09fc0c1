"""The linearisation of the homotopies in (x, y): n + 1 equations and one a bound, reduced to n + 1."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem, SingularError, Symmetric, factor_bordered
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.homotopies.cores import Full, Pairs, core_system
from problems.lcp.homotopies.sides import BoundPairs, Sides


@frozen(kw_only=True)
class Blend:
    """``sign [(1 - lam) (A x + q - y) + lam (x_ (x - x0) + y_ (y0 - y) + A_ A (x - x0))]`` with these x_, y_, A_.

    For y read s - t, the forces at lower and at upper bounds; x_ may differ from index to index.
    """

    sign: int
    x: int | Array = 0
    y: int = 0
    A: int = 0


@frozen(eq=False)
class PairSystem:
    """H' of such a homotopy at a point; `column` is the derivative of [...] with respect to lambda, shape (n,).

    `gap` is the distances of x from its bounds, one for each y; x itself for an LCP. `sizes` is what changes of x
    are compared with.
    """

    structure: Structure
    sides: Sides
    blend: Blend
    lam: float
    gap: Array
    y: Array
    c: Array
    column: Array
    sizes: Array

    @property
    def alpha(self) -> float:
        """The factor of A in d[...]/dx = alpha A + beta I."""
        return 1.0 - self.lam + self.lam * self.blend.A

    @property
    def beta(self) -> float | Array:
        """The factor of I in d[...]/dx."""
        return self.lam * self.blend.x

    @property
    def gamma(self) -> float:
        """d[...]/dy = -gamma I."""
        return 1.0 - self.lam + self.lam * self.blend.y

    def slope(self, v: Array) -> Array:
        """d[...]/dx applied to v."""
        product: Array = self.alpha * (self.structure.problem.A @ v) + self.beta * v
        return product

    def apply(self, v: Array) -> Array:
        """H' v, one shorter than v: one product with A."""
        n, l = self.column.size, v[-1]
        dx, dy = v[:n], v[n:-1]
        image = np.empty(v.size - 1)
        image[:n] = self.blend.sign * (self.slope(dx) - self.gamma * self.sides.force(dy) + self.column * l)
        image[n:] = self.y * self.sides.pull(dx) + self.gap * dy - self.c * l
        return image


@frozen(eq=False)
class ReducedPairs:
    """Order n + 1: one unknown of each pair eliminated."""

    system: PairSystem
    pairs: Pairs | BoundPairs
    border: Array
    core: BorderedSystem

    @property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix; the core's first n rows are those of [...]."""
        flipped = self.system.blend.sign < 0 and self.system.column.size % 2 == 1
        return -self.pairs.sign * self.core.sign if flipped else self.pairs.sign * self.core.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The full solution."""
        s, pairs, n = self.system, self.pairs, self.system.column.size
        v, p, dy = pairs.known(r[n:])
        top = s.blend.sign * r[:n] - s.slope(v) + s.gamma * p
        k = self.core.solve(top, rho - float(self.border[:n] @ v) - float(self.border[n:-1] @ dy))
        z = np.empty(r.size + 1)
        z[:n], z[n:-1] = pairs.of(k[:n], r[n:], k[n])
        z[-1] = k[n]
        return z


def factor_pairs(system: PairSystem, border: Array, refine: bool = True) -> BorderedSystem:
    """The bordered system at a point, of order 2n + 1 for an LCP, from a factorisation of order n + 1.

    With y eliminated the core is alpha A + beta I + gamma diag(y/x), with s/(x-l) + t/(u-x) for y/x: Cholesky if A is
    symmetric positive semidefinite and alpha, beta, gamma >= 0. Else of each index the unknown with the larger
    coefficient is kept, for LU. Without `refine` solutions are those of the definite core, where there is one. Raises
    `SingularError` if no core has a factorisation.
    """
    full = Full(system.apply, border, (system.sizes, system.y))

    def robust() -> BorderedSystem:
        return _reduced(system, border, system.sides.eliminated(system.y, system.gap, system.c, larger=True))

    return core_system(full, _definite(system, border), robust, refine)


def _definite(system: PairSystem, border: Array) -> ReducedPairs | None:
    """The core by Cholesky, where it is known to be positive definite."""
    structure = system.structure
    if structure.problem.sparse or np.any(np.less(system.blend.x, 0)):
        return None
    if not (structure.symmetric and structure.semidefinite):
        return None
    if not ((system.gap > 0.0).all() and (system.y > 0.0).all() and 0.0 <= system.lam <= 1.0):
        return None
    with np.errstate(all="ignore"):
        try:
            pairs = system.sides.eliminated(system.y, system.gap, system.c, larger=False)
            return _reduced(system, border, pairs, definite=True)
        except SingularError:
            return None


def _reduced(system: PairSystem, border: Array, pairs: Pairs | BoundPairs, definite: bool = False) -> ReducedPairs:
    s, n = system, system.column.size
    with np.errstate(all="ignore"):
        v, p, dy = pairs.known(s.c)
        column = s.column + s.slope(v) - s.gamma * p
        bx, by = border[:n], border[n:-1]
        row = np.append(bx * pairs.a + pairs.row(by), border[-1] + float(bx @ v) + float(by @ dy))
        diagonal = s.beta * pairs.a - s.gamma * pairs.b
        matrix = s.structure.scaled(s.alpha, pairs.a, diagonal)
        core = factor_bordered(Symmetric(matrix, definite=True) if definite else matrix, column, row)
        return ReducedPairs(s, pairs, border, core)
