"""Almost block diagonal matrices, periodic and bordered: condensed by orthogonal transformations, two blocks at a time.

Block i holds A_i x_i + B_i x_{i+1} + C_i g = r_i. Two neighbours give one by a QR factorisation of the columns of the
unknown between them, all pairs at once, until one block is left: in N log 2 such steps the work is that of N blocks.
No block is inverted and none multiplied by its neighbour, so that growing and decaying solutions do no harm (Wright,
Stable parallel algorithms for two-point boundary value problems, SIAM J. Sci. Stat. Comput. 13, 1992).
"""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from attrs import frozen
from scipy.linalg.lapack import dgetrf, dgetrs
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from continuation.arrays import Array
from continuation.linear import SingularError
from continuation.linear.dense import lu_sign


@frozen(eq=False)
class Level:
    """One elimination, of p unknowns in each of some blocks.

    `turned`: Q' of the blocks, shape (K, rows, rows). `inverse`, of shape (K, p, p): Of R. `follows`, of shape
    (K, p, 2 n + k): How what is eliminated follows from (left, right, g), with the other sign. `rest`: The same columns
    of the equations that are left.
    """

    turned: Array
    inverse: Array
    follows: Array
    rest: Array

    @classmethod
    def of(cls, middle: Array, outer: Array) -> Level:
        """Eliminate the columns `middle`; `outer` are those of (left, right, g)."""
        p = middle.shape[2]
        Q, R = np.linalg.qr(middle, mode="complete")
        turned = Q.transpose(0, 2, 1)
        try:
            inverse = np.linalg.inv(R[:, :p])
        except np.linalg.LinAlgError as error:
            raise SingularError("a block loses a rank") from error
        both = turned @ outer
        return cls(turned, inverse, inverse @ both[:, :p], both[:, p:])

    @property
    def sign(self) -> float:
        """Sign of the determinants of what is eliminated."""
        return float(np.prod(np.sign(np.linalg.det(self.turned)) * np.sign(np.linalg.det(self.inverse))))


@frozen(eq=False, slots=False)
class Condensed:
    """All levels: the finest one, which eliminates what is inside of the blocks, first.

    `n`: Size of the x_i. `k`: Of g.
    """

    levels: list[Level]
    n: int
    k: int

    @classmethod
    def of(cls, blocks: Array, g: Array) -> Condensed:
        """Blocks of shape (N, m n, (m + 1) n), of the nodes of each interval, and g of shape (N, m n, k)."""
        rows, n = blocks.shape[1], blocks.shape[2] - blocks.shape[1]
        outer = np.concatenate([blocks[:, :, :n], blocks[:, :, rows:], g], axis=2)
        levels = [Level.of(blocks[:, :, n:rows], outer)]
        rest = levels[0].rest
        while len(rest) > 1:
            level, rest = _halved(rest, n)
            levels.append(level)
        return cls(levels, n, g.shape[2])

    @cached_property
    def last(self) -> tuple[Array, Array, Array]:
        """(A, B, C) of the one block that is left: A x_0 + B x_N + C g = r."""
        rest = self.levels[-1].rest[-1]
        return rest[:, : self.n], rest[:, self.n : 2 * self.n], rest[:, 2 * self.n :]

    def forward(self, r: Array) -> tuple[list[Array], Array]:
        """The right-hand side, of shape (N, m n), through all levels: what eliminated unknowns have of it; the rest."""
        parts = []
        for level in self.levels:
            rows = level.turned.shape[1]
            count, p = len(level.turned), level.inverse.shape[1]
            used = count * rows // r.shape[1]
            both, kept = level.turned @ r[:used].reshape(count, rows, 1), r[used:]
            parts.append((level.inverse @ both[:, :p])[:, :, 0])
            r = np.concatenate([both[:, p:, 0], kept]) if len(kept) else both[:, p:, 0]
        return parts, r[0]

    def backward(self, ends: Array, g: Array, parts: list[Array] | None = None) -> Array:
        """All unknowns but the last x_N, shape (N m, n, c), from x_0 and x_N, of shape (2, n, c), and g, (k, c)."""
        n, c = self.n, ends.shape[2]
        coarse = ends
        for j in range(len(self.levels) - 1, -1, -1):
            level = self.levels[j]
            count, p = len(level.turned), level.inverse.shape[1]
            outer = np.concatenate(
                [coarse[:count], coarse[1 : count + 1], np.broadcast_to(g, (count, *g.shape))], axis=1
            )
            middle = -(level.follows @ outer)
            if parts is not None:
                middle += parts[j][:, :, None]
            fine = np.concatenate([coarse[:count, None], middle.reshape(count, p // n, n, c)], axis=1)
            coarse = np.concatenate([fine.reshape(-1, n, c), coarse[count:]])
        return coarse[:-1]

    def sign(self) -> float:
        """Sign of the determinant of all that is eliminated, and of the order in which that is."""
        rows, blocks = self.levels[0].turned.shape[1], len(self.levels[0].turned)
        return float(np.prod([level.sign for level in self.levels])) * _parity(blocks, rows, self.n)


def _halved(rest: Array, n: int) -> tuple[Level, Array]:
    """Pairs of neighbours made one; the last of an odd number is kept."""
    count = len(rest) // 2
    pairs = rest[: 2 * count].reshape(count, 2 * n, -1)
    upper, lower = pairs[:, :n], pairs[:, n:]
    outer = np.concatenate([pairs[:, :, :n], pairs[:, :, n:]], axis=2)
    outer[:, :n, n : 2 * n] = 0.0
    outer[:, n:, :n] = 0.0
    level = Level.of(np.concatenate([upper[:, :, n : 2 * n], lower[:, :, :n]], axis=1), outer)
    return level, np.concatenate([level.rest, rest[2 * count :]])


@lru_cache(maxsize=16)
def _parity(blocks: int, rows: int, n: int) -> float:
    """Of the order in which rows and unknowns are eliminated."""
    total = blocks * rows
    row, column = np.arange(total).reshape(blocks, rows), np.arange(total).reshape(blocks, rows)
    rows_gone, columns_gone = [row[:, : rows - n].ravel()], [column[:, n:].ravel()]
    row, column = row[:, rows - n :], column[:, :n]
    while len(row) > 1:
        count = len(row) // 2
        both = row[: 2 * count].reshape(count, 2 * n)
        rows_gone.append(both[:, :n].ravel())
        columns_gone.append(column[1 : 2 * count : 2].ravel())
        row = np.concatenate([both[:, n:], row[2 * count :]])
        column = np.concatenate([column[: 2 * count : 2], column[2 * count :]])
    sign = 1.0
    for order in (np.concatenate([*rows_gone, row.ravel()]), np.concatenate([*columns_gone, column.ravel()])):
        cycles = connected_components(csr_array((np.ones(total), (np.arange(total), order))), directed=False)[0]
        sign *= -1.0 if (total - cycles) % 2 else 1.0
    return sign


@frozen(eq=False, slots=False)
class Bordered:
    """The periodic matrix with k - 1 more equations and a border, factored: x_N = x_0.

    `rows`, of shape (k, M + k): The further equations and the border, divided by `sizes`. `scale`, of shape (M + k,):
    Of the unknowns. `equations`, of shape (M,): What the equations are divided by. All of `blocks` and `rows` is in
    these units. `pinned`: The border's entries at unknowns behind the M + k - 1, each with an equation of its own that
    says what it is; the parameter comes last.
    """

    blocks: Condensed
    rows: Array
    sizes: Array
    scale: Array
    equations: Array
    pinned: Array

    @cached_property
    def _basis(self) -> Array:
        """All unknowns, as they follow from x_0 and g: shape (M + k, n + k)."""
        n, k = self.blocks.n, self.blocks.k
        x, g = np.eye(n, n + k), np.eye(k, n + k, n)
        return np.concatenate([self.blocks.backward(np.array([x, x]), g).reshape(-1, n + k), g])

    @cached_property
    def small(self) -> tuple[Array, Any]:
        """LU of what is left when all but x_0 and g is eliminated; SingularError where that is singular."""
        A, B, C = self.blocks.last
        matrix = np.vstack([np.hstack([A + B, C]), self.rows @ self._basis])
        lu, pivots, _ = dgetrf(matrix)
        if not (np.isfinite(lu).all() and lu.diagonal().all()):
            raise SingularError("the condensed matrix is singular, or not finite")
        return lu, pivots

    @cached_property
    def sign(self) -> int:
        """Sign of the determinant."""
        lu, pivots = self.small
        return int(self.blocks.sign() * lu_sign(pivots, lu.diagonal()))

    def solve(self, r: Array, rho: float) -> Array:
        """The solution z, of shape (M + k,)."""
        M, n, k = self.equations.size, self.blocks.n, self.blocks.k
        r, given = r[: M + k - 1], r[M + k - 1 :]
        rho = rho - float(self.pinned @ given)
        count, size = len(self.blocks.levels[0].turned), self.blocks.levels[0].turned.shape[1]
        parts, last = self.blocks.forward((r[:M] / self.equations).reshape(count, size))
        own = self.blocks.backward(np.zeros((2, n, 1)), np.zeros((k, 1)), parts).ravel()
        rest = np.concatenate([last, np.append(r[M:], rho) / self.sizes])
        rest[n:] -= self.rows[:, :M] @ own
        z = self._basis @ dgetrs(*self.small, rest)[0]
        z[:M] += own
        z = z * self.scale
        return np.concatenate([z[:-1], given, z[-1:]])
