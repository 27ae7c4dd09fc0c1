"""Inequalities that hold without complementarity, and conditions on their multipliers.

A solution has l <= x <= u, w_i >= 0 without an upper bound, w_i <= 0 without a lower one, w_i = 0 without both.
Multipliers y with y'w >= 0 give 0 <= y'(A x + q), so

    q'y + sum_j sup {(A'y)_j x_j : l_j <= x_j <= u_j} < 0

proves that no such x exists.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import MixedLCP
from problems.lcp.proof.rational import IntegerRow, integer_rows


@frozen(eq=False)
class Inequalities:
    """The points z >= 0 with A z + q >= 0.

    `rows` and `signs` refer to the problem's rows (-1 for bounds); None if unchanged.
    """

    A: Matrix
    q: Array
    rows: NDArray[np.intp] | None = None
    signs: Array | None = None

    @property
    def n(self) -> int:
        """The number of rows."""
        return int(self.q.size)

    @property
    def sparse(self) -> bool:
        """Whether A is sparse."""
        return bool(sp.issparse(self.A))

    def on_rows(self, y: Any, n: int) -> Any:
        """Multipliers on the problem's n rows."""
        y = np.asarray(y)
        if self.rows is None or self.signs is None:
            return y
        own, total = self.rows >= 0, np.zeros(n, dtype=y.dtype)
        np.add.at(total, self.rows[own], np.where(self.signs[own] > 0.0, y[own], -y[own]))
        return total


def inequalities(problem: MixedLCP) -> Inequalities:
    """A problem's inequalities, without rounding."""
    if problem.standard:
        return Inequalities(problem.A, problem.q)
    n, low, high = problem.n, problem.lower, problem.upper
    finite_low, finite_high = low > -np.inf, high < np.inf
    up = low == 0.0
    down = (high == 0.0) & ~up
    both = np.flatnonzero(~up & ~down)
    every: NDArray[np.intp] = np.arange(n)
    columns = sp.csr_array(sp.diags_array(np.where(down, -1.0, 1.0)))
    columns = sp.hstack([columns, -sp.eye_array(n, format="csr")[:, both]], format="csr")
    A, identity = sp.csr_array(problem.A), sp.eye_array(n, format="csr")
    parts = [
        (A, ~finite_high, 1.0, problem.q, every),
        (A, ~finite_low, -1.0, -problem.q, every),
        (identity, finite_low & ~up, 1.0, -low, np.full(n, -1)),
        (identity, finite_high & ~down, -1.0, high, np.full(n, -1)),
    ]
    matrix = sp.vstack([sign * (rows[kept] @ columns) for rows, kept, sign, _, _ in parts], format="csr")
    q = np.concatenate([constant[kept] for _, kept, _, constant, _ in parts])
    owner = np.concatenate([place[kept] for _, kept, _, _, place in parts])
    signs = np.concatenate([np.full(int(kept.sum()), sign) for _, kept, sign, _, _ in parts])
    return Inequalities(matrix if problem.sparse else matrix.toarray(), q, owner, signs)


@frozen
class Conditions:
    """The conditions on a multiplier, in integers. `signs` say whether y_i may be positive, negative."""

    columns: list[IntegerRow]
    constant: IntegerRow
    lower: list[float]
    upper: list[float]
    signs: list[tuple[bool, bool]]

    def gap(self, y: list[int]) -> Fraction | None:
        """The gap q'y + sup (A'y)'x; None if infinite or y is not allowed."""
        if not any(y):
            return None
        for value, (positive, negative) in zip(y, self.signs):
            if (value > 0 and not positive) or (value < 0 and not negative):
                return None
        total = Fraction(self.constant.times(y, 1), 1 << self.constant.shift)
        for column, low, high in zip(self.columns, self.lower, self.upper):
            slope = column.times(y, 1)
            if slope:
                bound = high if slope > 0 else low
                if math.isinf(bound):
                    return None
                if bound:
                    total += Fraction(slope, 1 << column.shift) * Fraction(bound)
        return total


def conditions_of(problem: MixedLCP | Inequalities) -> Conditions:
    """Conditions on a multiplier."""
    A = sp.csr_array(problem.A.T) if problem.sparse else problem.A.T
    columns = integer_rows(A, np.zeros(A.shape[0]))
    constant = integer_rows(problem.q[None, :], np.zeros(1))[0]
    if isinstance(problem, Inequalities):
        size = A.shape[0]
        return Conditions(columns, constant, [0.0] * size, [math.inf] * size, [(True, False)] * problem.n)
    unbounded = zip(np.isinf(problem.upper).tolist(), np.isinf(problem.lower).tolist())
    return Conditions(columns, constant, problem.lower.tolist(), problem.upper.tolist(), list(unbounded))
