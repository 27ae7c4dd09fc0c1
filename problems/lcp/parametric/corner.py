"""A corner of a path where several switches vanish at once: the small LCP whose solutions are all rays that leave.

``u' = S v' + r e'``, ``0 <= u' _|_ v' >= 0``: u are the distances that have fallen to zero, v those of their
complements, which may grow from there, and e the variable that drives the path.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from attrs import frozen
from scipy.linalg import null_space

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.almost import Ended
from problems.lcp.pivoting.starts import covering

LARGEST_LISTED = 10
"""Switches up to which all 2^m pieces are tried: 30 ms for ten; beyond, the one ray that pivots find."""

FEW = 1e-9
"""Relative to the largest: what of a ray's components, and of the pieces' singular values, counts as zero."""

IRRATIONAL = 0.5 * (5.0**0.5 - 1.0)
"""Multiples of it, modulo one, are in no position that is special: by these the corner's switches are set apart."""

AT_ORDER = 50
"""Pivots at most, times the number of switches."""


@frozen(eq=False)
class Ray:
    """A ray of the small LCP.

    Attributes
    ----------
    grown : Array of shape (m,)
        v', not negative.
    driven : float
        e', of any sign.
    """

    grown: Array
    driven: float

    @property
    def back(self) -> bool:
        """Whether the path has come along it."""
        return self.driven < 0.0 and not self.grown.any()


@frozen(eq=False)
class Way:
    """The basis behind a corner.

    Attributes
    ----------
    switched : tuple of int
        Of the m switches, those whose piece is another one.
    driver : int
        The switch whose pair drives from here on.
    ray : Ray
        Where it leads.
    """

    switched: tuple[int, ...]
    driver: int
    ray: Ray


def rays(S: Array, r: Array) -> list[Ray]:
    """All rays, that from which the path has come included; where they fill a cone, its edges.

    Parameters
    ----------
    S : ndarray, shape (m, m)
    r : ndarray, shape (m,)
        The path has come with e' = 1 and u' = r <= 0.
    """
    m = r.size
    # Rows and columns in like units, so that zero may be told.
    unit = np.maximum(np.abs(r), np.abs(S).max(axis=1))
    unit = np.where(unit > 0.0, unit, 1.0)
    whole = np.column_stack([S / unit[:, None], r / unit])
    wide = np.abs(whole[:, :m]).max(axis=0)
    wide = np.where(wide > 0.0, wide, 1.0)
    whole[:, :m] /= wide
    found: list[Array] = []
    for size in range(m + 1):
        for active in combinations(range(m), size):
            columns = [*active, m]
            rest = [i for i in range(m) if i not in active]
            block = whole[np.ix_(list(active), columns)]
            kernel = null_space(block, rcond=FEW) if active else np.ones((1, 1))
            signs = np.vstack([np.eye(size, size + 1), whole[np.ix_(rest, columns)]]) @ kernel
            for edge in _edges(signs):
                along = np.zeros(m + 1)
                along[columns] = kernel @ edge
                along /= np.abs(along).max()
                along[:m] = np.where(along[:m] > FEW, along[:m], 0.0)
                if not any(np.abs(along - one).max() <= 1e3 * FEW for one in found):
                    found.append(along)
    return [Ray(along[:m] / wide, float(along[m])) for along in found]


def _edges(signs: Array) -> list[Array]:
    """The edges of the cone ``signs @ c >= 0``, each a vector c."""
    dimension = signs.shape[1]
    if dimension == 0:
        return []
    candidates = []
    for chosen in combinations(range(signs.shape[0]), dimension - 1):
        kernel = null_space(signs[list(chosen)], rcond=FEW) if chosen else np.ones((1, 1))
        if kernel.shape[1] == 1:
            candidates += [kernel[:, 0], -kernel[:, 0]]
    return [c for c in candidates if (signs @ c >= -FEW).all()]


def way(S: Array, r: Array) -> Way | None:
    """The way on, by pivots from where the path has come, with the switches set apart: then no two vanish at once.

    Parameters
    ----------
    S : ndarray, shape (m, m)
    r : ndarray, shape (m,)

    Returns
    -------
    Way or None
        None where rounding leads nowhere.

    References
    ----------
    Cottle, Pang and Stone, section 4.9: that a perturbed problem, like a lexicographic rule, resolves ties.
    """
    m = r.size
    apart = 1.0 + np.arange(1, m + 1) * IRRATIONAL % 1.0
    scale = np.maximum(np.abs(r), np.abs(S).max(axis=1))
    apart *= np.where(scale > 0.0, scale, 1.0)
    table = np.column_stack([S, r, apart])
    basic, other = np.arange(m), np.arange(m, 2 * m + 1)
    column = m
    for _ in range(AT_ORDER * m):
        slopes = -table[:, column]
        falling = np.flatnonzero((slopes > FEW * np.abs(slopes).max(initial=0.0)) & (basic != 2 * m))
        if falling.size == 0:
            entering = int(other[column])
            if entering == 2 * m:
                return None
            rates = np.zeros(2 * m + 1)
            rates[basic], rates[entering] = table[:, column], 1.0
            rates[np.abs(rates) <= FEW * np.abs(rates).max()] = 0.0
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


def a_solution(S: Array, r: Array) -> Array | None:
    """A v' >= 0 with ``S v' + r >= 0``, complementary, by Lemke's method; None where that ends on a ray.

    Parameters
    ----------
    S : ndarray, shape (m, m)
    r : ndarray, shape (m,)
    """
    path = covering(LCP(S, r), np.ones(r.size))
    if path is None or path.run(AT_ORDER * r.size) is not Ended.REACHED:
        return None
    grown = np.zeros(r.size)
    active = np.flatnonzero(path.active)
    grown[active] = np.linalg.solve(S[np.ix_(active, active)], -r[active])
    return grown
