"""Corners where many switches vanish, passed by pivots in the small LCP of their rays.

``u' = S v' + r e'``, ``0 <= u' _|_ v' >= 0``, with distances u, complements v and the driving variable e.
"""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import ROOT_OF_ROUND_OFF, Array, generic_vector

ZERO_COMPONENT = ROOT_OF_ROUND_OFF
"""Smaller components and singular values, relative to the largest, are zero."""

PIVOTS_PER_SWITCH = 50
"""Most pivots per switch."""


@frozen(eq=False)
class Ray:
    """A ray of the small LCP.

    `grown`: v' >= 0, shape (m,). `driven`: e'.
    """

    grown: Array
    driven: float

    @property
    def back(self) -> bool:
        """Whether the path came along it."""
        return self.driven < 0.0 and not self.grown.any()


@frozen(eq=False)
class Way:
    """The basis behind a corner; `switched`: switches that change; `driver`: the next driving pair."""

    switched: tuple[int, ...]
    driver: int
    ray: Ray


def way(S: Array, r: Array) -> Way | None:
    """Basis behind the corner, by pivots with perturbed switches, or None.

    The perturbation, like a lexicographic rule, resolves ties (Cottle, Pang and Stone, section 4.9).
    """
    m = r.size
    apart = 1.5 + 0.5 * generic_vector(m)
    scale = np.maximum(np.abs(r), np.abs(S).max(axis=1))
    apart *= np.where(scale > 0.0, scale, 1.0)
    table = np.column_stack([S, r, apart])
    basic, other = np.arange(m), np.arange(m, 2 * m + 1)
    column = m
    for _ in range(PIVOTS_PER_SWITCH * m):
        slopes = -table[:, column]
        falling = np.flatnonzero((slopes > ZERO_COMPONENT * np.abs(slopes).max(initial=0.0)) & (basic != 2 * m))
        if falling.size == 0:
            entering = int(other[column])
            if entering == 2 * m:
                return None
            rates = np.zeros(2 * m + 1)
            rates[basic], rates[entering] = table[:, column], 1.0
            rates[np.abs(rates) <= ZERO_COMPONENT * np.abs(rates).max()] = 0.0
            switched = [*basic[(basic >= m) & (basic < 2 * m)].tolist(), *([entering] if entering >= m else [])]
            return Way(tuple(i - m for i in switched), entering % m, Ray(rates[m : 2 * m], float(rates[2 * m])))
        row = int(falling[np.argmin(table[falling, -1] / slopes[falling])])
        pivot = table[row, column]
        moved = table[row] / -pivot
        moved[column] = 1.0 / pivot
        steep = table[:, column].copy()
        table[:, column] = 0.0
        table += np.outer(steep, moved)
        table[row] = moved
        leaving = int(basic[row])
        basic[row], other[column] = other[column], leaving
        column = int(np.flatnonzero(other == (leaving + m if leaving < m else leaving - m))[0])
    return None
