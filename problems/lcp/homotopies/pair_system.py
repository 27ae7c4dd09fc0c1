"""The linearisation of the homotopies in (x, y): 2n + 1 equations, reduced to n + 1."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem, SingularError, Symmetric, factor_bordered
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.homotopies.cores import Full, Pairs, core_system, larger_eliminated, second_eliminated


@frozen(kw_only=True)
class Blend:
    """``sign [(1 - lam) (A x + q - y) + lam (x_ (x - x0) + y_ (y0 - y) + A_ A (x - x0))]`` with these x_, y_, A_."""

    sign: int
    x: int = 0
    y: int = 0
    A: int = 0


@frozen(eq=False)
class PairSystem:
    """H' of such a homotopy at a point; `column` is the derivative of [...] with respect to lambda, shape (n,)."""

    structure: Structure
    blend: Blend
    lam: float
    x: Array
    y: Array
    c: Array
    column: Array

    @property
    def alpha(self) -> float:
        """The factor of A in d[...]/dx = alpha A + beta I."""
        return 1.0 - self.lam + self.lam * self.blend.A

    @property
    def beta(self) -> float:
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
        """H' v, shape (2n,), for v of shape (2n + 1,): one product with A."""
        n, l = self.x.size, v[-1]
        dx, dy = v[:n], v[n:-1]
        image = np.empty(2 * n)
        image[:n] = self.blend.sign * (self.slope(dx) - self.gamma * dy + self.column * l)
        image[n:] = self.y * dx + self.x * dy - self.c * l
        return image


@frozen(eq=False)
class ReducedPairs:
    """Order n + 1: one unknown of each pair eliminated."""

    system: PairSystem
    pairs: Pairs
    border: Array
    core: BorderedSystem

    @property
    def sign(self) -> int:
        """Sign of the determinant of the full bordered matrix; the core's first n rows are those of [...]."""
        flipped = self.system.blend.sign < 0 and self.system.x.size % 2 == 1
        return -self.pairs.sign * self.core.sign if flipped else self.pairs.sign * self.core.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The full solution, shape (2n + 1,)."""
        s, pairs, n = self.system, self.pairs, self.system.x.size
        v, p = pairs.e * r[n:], pairs.f * r[n:]
        top = s.blend.sign * r[:n] - s.slope(v) + s.gamma * p
        k = self.core.solve(top, rho - float(self.border[:n] @ v) - float(self.border[n:-1] @ p))
        z = np.empty(2 * n + 1)
        z[:n], z[n:-1] = pairs.of(k[:n], r[n:], k[n])
        z[-1] = k[n]
        return z


def factor_pairs(system: PairSystem, border: Array, refine: bool = True) -> BorderedSystem:
    """The bordered system of order 2n + 1 at a point, from a factorisation of order n + 1.

    With y eliminated the core is alpha A + beta I + gamma diag(y/x): Cholesky if A is symmetric positive semidefinite
    and alpha, beta, gamma >= 0. Else of each pair the unknown with the larger coefficient is eliminated, for LU.

    Parameters
    ----------
    system : PairSystem
    border : Array of shape (2n + 1,)
    refine : bool
        Whether solutions are corrected in full. Without it they are those of the definite core, where there is one.

    Raises
    ------
    SingularError
        If no core has a factorisation.
    """
    full = Full(system.apply, border, (system.x, system.y))

    def robust() -> BorderedSystem:
        return _reduced(system, border, larger_eliminated(system.y, system.x, system.c))

    return core_system(full, _definite(system, border), robust, refine)


def _definite(system: PairSystem, border: Array) -> ReducedPairs | None:
    """The core by Cholesky, where it is known to be positive definite."""
    structure = system.structure
    if structure.problem.sparse or system.blend.x < 0 or not (structure.symmetric and structure.semidefinite):
        return None
    if not ((system.x > 0.0).all() and (system.y > 0.0).all() and 0.0 <= system.lam <= 1.0):
        return None
    with np.errstate(all="ignore"):
        try:
            return _reduced(system, border, second_eliminated(system.y, system.x, system.c), definite=True)
        except SingularError:
            return None


def _reduced(system: PairSystem, border: Array, pairs: Pairs, definite: bool = False) -> ReducedPairs:
    s, n = system, system.x.size
    with np.errstate(all="ignore"):
        v, p = pairs.e * s.c, pairs.f * s.c
        column = s.column + s.slope(v) - s.gamma * p
        bx, by = border[:n], border[n:-1]
        row = np.append(bx * pairs.a + by * pairs.b, border[-1] + float(bx @ v) + float(by @ p))
        matrix = s.structure.scaled(s.alpha, pairs.a, s.beta * pairs.a - s.gamma * pairs.b)
        core = factor_bordered(Symmetric(matrix, definite=True) if definite else matrix, column, row)
        return ReducedPairs(s, pairs, border, core)
