"""Rows and columns brought to comparable size by powers of two, which is exact, and undone in the answer."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.proof.farkas import scaled_data, scales

SPREAD = 1e4
"""Ratio of the largest to the smallest row (or column) from which on a problem is scaled: below, its units are kept."""


@frozen(eq=False)
class Scaled:
    """LCP(q / r, A / (r c)): its solution u gives x = u / c, and its w is w / r.

    Attributes
    ----------
    problem : LCP
    columns : Array of shape (n,)
        c.
    """

    problem: LCP
    columns: Array

    def x(self, u: Array) -> Array:
        """The point of the problem as given."""
        return u / self.columns

    def u(self, x: Array) -> Array:
        """The point of the scaled problem."""
        return x * self.columns


def balanced(problem: LCP) -> Scaled | None:
    """The scaled problem, or None where the problem as given needs no scaling.

    A symmetric scaling r = c = sqrt(diag A), which keeps definiteness and symmetry, where that does; else rows of
    [A, q] and then columns of A get maximum 1.
    """
    if _alike(problem):
        return None
    rows, columns = scales(problem)
    if max(_spread(rows), _spread(columns)) <= SPREAD:
        return None
    diagonal = problem.A.diagonal()
    if (diagonal > 0.0).all():
        root = np.exp2(np.round(0.5 * np.log2(diagonal)))
        alike = LCP(*scaled_data(problem, root, root))
        if max(map(_spread, scales(alike))) <= SPREAD:
            return Scaled(alike, root)
    return Scaled(LCP(*scaled_data(problem, rows, columns)), columns)


def _alike(problem: LCP) -> bool:
    """Whether sizes alone, which are quickly found, exclude that `scales` spread too far; for a dense matrix."""
    if problem.sparse:
        return False
    A = problem.A
    columns = np.maximum(A.max(axis=0), -A.min(axis=0))
    rows = np.maximum(np.maximum(A.max(axis=1), -A.min(axis=1)), np.abs(problem.q))
    if rows.min() <= 0.0 or columns.min() <= 0.0:
        return False
    # Powers of two are off by a factor 2 at most, and a row's scale changes a column's maximum by that of the rows.
    return 4.0 * _spread(rows) * _spread(columns) <= SPREAD


def _spread(values: Array) -> float:
    return float(values.max() / values.min())
