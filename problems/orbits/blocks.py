"""Condenses A_i x_i + B_i x_{i+1} = 0 to A x_0 + B x_N = 0.

QR factorisations eliminate unknowns between blocks, so growing and decaying solutions lose no digits (Wright, Stable
parallel algorithms for two-point boundary value problems, SIAM J. Sci. Stat. Comput. 13, 1992).
"""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear import SingularError


@frozen(eq=False)
class Condensed:
    """Eliminations, and the remaining block.

    `follows` maps (left, right) to minus p unknowns of K blocks, shape (K, p, 2 n).
    """

    follows: list[Array]
    A: Array
    B: Array

    @classmethod
    def of(cls, blocks: Array) -> Condensed:
        """Condense blocks of shape (N, m n, (m + 1) n)."""
        rows, n = blocks.shape[1], blocks.shape[2] - blocks.shape[1]
        first, rest = _eliminated(blocks[:, :, n:rows], np.concatenate([blocks[:, :, :n], blocks[:, :, rows:]], axis=2))
        follows = [first]
        while len(rest) > 1:
            count = len(rest) // 2
            upper, lower = rest[: 2 * count : 2], rest[1 : 2 * count : 2]
            outer = np.zeros((count, 2 * n, 2 * n))
            outer[:, :n, :n], outer[:, n:, n:] = upper[:, :, :n], lower[:, :, n:]
            level, kept = _eliminated(np.concatenate([upper[:, :, n:], lower[:, :, :n]], axis=1), outer)
            follows.append(level)
            rest = np.concatenate([kept, rest[2 * count :]])
        return cls(follows, rest[0, :, :n], rest[0, :, n:])

    def all_from(self, ends: Array) -> Array:
        """Unknowns before x_N, shape (N m, n), from (x_0, x_N)."""
        n = ends.shape[1]
        for level in reversed(self.follows):
            count = len(level)
            outer = np.concatenate([ends[:count], ends[1 : count + 1]], axis=1)
            middle = -(level @ outer[:, :, None]).reshape(count, -1, n)
            fine = np.concatenate([ends[:count, None], middle], axis=1)
            ends = np.concatenate([fine.reshape(-1, n), ends[count:]])
        return ends[:-1]


def _eliminated(middle: Array, outer: Array) -> tuple[Array, Array]:
    """Express `middle`'s unknowns by `outer`'s; return the remaining equations too."""
    p = middle.shape[2]
    Q, R = np.linalg.qr(middle, mode="complete")
    both = Q.transpose(0, 2, 1) @ outer
    try:
        return np.linalg.solve(R[:, :p], both[:, :p]), both[:, p:]
    except np.linalg.LinAlgError as error:
        raise SingularError("a block loses a rank") from error
