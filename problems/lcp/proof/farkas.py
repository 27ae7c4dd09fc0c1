"""Multipliers, checked in integers, prove that an LCP has no feasible point.

For y >= 0 with A'y <= 0, a feasible x gives 0 <= y'w = (A'y)'x + q'y <= q'y. So q'y < 0 proves that none exists
(Farkas).
"""

from __future__ import annotations

from fractions import Fraction
from math import gcd

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray
from scipy.optimize import linprog

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import MixedLCP, require_problem
from problems.lcp.proof.compensated import row_terms
from problems.lcp.proof.inequalities import Inequalities, conditions_of, inequalities
from problems.lcp.proof.rational import Integers, block_of, integers, solve_exactly

HIGHS_TOLERANCE = 1e-10
"""The tightest feasibility tolerance of HiGHS."""
MULTIPLIER_ZERO = 1e-9
"""Smaller scaled values are zero: ten times HiGHS's tolerance."""

PRECISION = 100 * float(np.finfo(float).eps)
"""Smaller relative errors of A'y <= 0 are rounding."""
GAP_IN_DOUBT = 1e-6
"""Smaller gaps -q'y, relative to |q|'y, need an exact proof."""
_NEARLY_TIGHT = 1e-7
"""Smaller relative values are equations in the refinement."""
LARGEST_REFINED = 1500
"""Largest refinement: least squares of this order take seconds."""
LARGEST_VERTEX = 100
"""Largest order at which tight equations are solved in rationals: 0.1 s."""


@frozen(eq=False)
class Farkas:
    """A multiplier y >= 0 with A'y <= 0, q'y < 0, checked in integers.

    With bounds see `inequalities`.

    Attributes
    ----------
    y : tuple of n int
        Without a common factor.
    gap : Fraction
        q'y (with bounds, q'y + sup (A'y)'x), negative.
    """

    y: tuple[int, ...]
    gap: Fraction

    def in_units(self, problem: MixedLCP, rows: NDArray[np.int64]) -> Farkas | None:
        """Undo a scaling of rows by 2^rows.

        Parameters
        ----------
        problem : MixedLCP
        rows : ndarray of int, shape (n,)
        """
        least = int(rows.min())
        y = [value << (int(power) - least) for value, power in zip(self.y, rows)]
        return multiplier(problem, y)

    def holds(self, problem: MixedLCP) -> bool:
        """Whether it proves `problem` infeasible.

        Parameters
        ----------
        problem : MixedLCP
        """
        return multiplier(problem, list(self.y)) is not None


@frozen(eq=False)
class FloatFarkas:
    """A multiplier that proves infeasibility up to rounding.

    A matrix within `error` of A, relatively in each entry, has A'y <= 0 exactly.

    Attributes
    ----------
    y : Array of shape (n,)
        Its largest entry is 1.
    error : float
        max_j (A'y)_j / (|A|'y)_j, about the rounding unit.
    gap : float
        -q'y / |q|'y, at least `GAP_IN_DOUBT`.
    """

    y: Array
    error: float
    gap: float

    def in_units(self, rows: NDArray[np.int64]) -> FloatFarkas:
        """Undo a scaling of rows by 2^rows.

        Parameters
        ----------
        rows : ndarray of int, shape (n,)
        """
        y = np.ldexp(self.y, rows - int(rows[self.y != 0.0].max()))
        return FloatFarkas(y / np.abs(y).max(), self.error, self.gap)


def farkas(problem: MixedLCP) -> Farkas | None:
    """Prove that {x >= 0, A x + q >= 0}, or its counterpart with bounds, is empty.

    The result is None if no multiplier passes the exact check.

    Parameters
    ----------
    problem : MixedLCP

    References
    ----------
    Farkas 1902; Cottle, Pang and Stone, Theorem 2.7.9.
    """
    require_problem(problem)
    found = infeasibility(problem)
    return found if isinstance(found, Farkas) else None


def infeasibility(problem: MixedLCP, guess: Array | None = None) -> Farkas | FloatFarkas | None:
    """A proof of infeasibility, exact or to working precision, or None.

    Up to order `LARGEST_VERTEX` rationals are tried. `guess`, shape (n,): replaces the linear program's multiplier.
    """
    scaled = _Scaled.of(problem)
    if (scaled.system.q >= 0.0).all():
        return None  # z = 0 is feasible
    if guess is None:
        guess = by_linear_program(scaled.A, scaled.q)
    else:
        guess = guess * scaled.rows / max(float((guess * scaled.rows).max()), np.finfo(float).tiny)
    if guess is None or not float(scaled.q @ guess) < 0.0 or float((scaled.A.T @ guess).max()) > _NEARLY_TIGHT:
        return None
    return scaled.exact(guess) or scaled.nearly(guess)


def by_linear_program(matrix: Matrix, vector: Array) -> Array | None:
    """Minimise q'y subject to A'y <= 0, sum y = 1, y >= 0; None on failure."""
    n = vector.size
    total = sp.csr_array(np.ones((1, n))) if sp.issparse(matrix) else np.ones((1, n))
    result = linprog(
        vector, A_ub=transposed(matrix), b_ub=np.zeros(matrix.shape[1]), A_eq=total, b_eq=[1.0], bounds=(0, None),
        method="highs",
        options={"primal_feasibility_tolerance": HIGHS_TOLERANCE, "dual_feasibility_tolerance": HIGHS_TOLERANCE},
    )  # fmt: skip
    return np.maximum(result.x, 0.0) if result.status == 0 else None


def transposed(matrix: Matrix) -> Matrix:
    """A', stored as A is."""
    return sp.csr_array(matrix.T) if sp.issparse(matrix) else matrix.T


def scales(problem: MixedLCP | Inequalities) -> tuple[Array, Array]:
    """Powers of two r, c: rows of [A, q] over r, then columns of A over c, have maximum about 1."""
    size: Matrix = abs(problem.A)
    largest = np.asarray(size.max(axis=1).toarray()).ravel() if problem.sparse else size.max(axis=1)
    rows = _power_of_two(np.maximum(largest, np.abs(problem.q)))
    scaled = sp.diags_array(1.0 / rows) @ size if problem.sparse else size / rows[:, None]
    largest = np.asarray(scaled.max(axis=0).toarray()).ravel() if problem.sparse else scaled.max(axis=0)
    return rows, _power_of_two(largest)


def scaled_data(problem: MixedLCP | Inequalities, rows: Array, columns: Array) -> tuple[Matrix, Array]:
    """A divided by `rows` and `columns`, q divided by `rows`; exact for powers of two."""
    if problem.sparse:
        return sp.diags_array(1.0 / rows) @ problem.A @ sp.diags_array(1.0 / columns), problem.q / rows
    return problem.A / rows[:, None] / columns, problem.q / rows


def _power_of_two(values: Array) -> Array:
    # Of zero it is 1.
    return np.asarray(np.ldexp(1.0, np.clip(np.frexp(values)[1], -500, 500)))


@frozen(eq=False)
class _Scaled:
    """A problem's inequalities, and their scaled data."""

    problem: MixedLCP
    system: Inequalities
    A: Matrix
    q: Array
    rows: Array

    @classmethod
    def of(cls, problem: MixedLCP) -> _Scaled:
        system = inequalities(problem)
        rows, columns = scales(system)
        matrix, vector = scaled_data(system, rows, columns)
        return cls(problem, system, matrix, vector / _power_of_two(np.abs(vector).max(keepdims=True)), rows)

    def exact(self, guess: Array) -> Farkas | None:
        """A rational proof: the guess, scaled by the rows, or the solution of its tight conditions; else None."""
        weights = integers(self.rows.max() / self.rows)[0]
        rounded = [value * weight for value, weight in zip(integers(guess / guess.max())[0], weights)]
        return self._proved(rounded) or self._proved(self._vertex(guess))

    def _proved(self, y: list[int] | None) -> Farkas | None:
        if y is None:
            return None
        return multiplier(self.problem, self.system.on_rows(np.array(y, dtype=object), self.problem.n).tolist())

    def _vertex(self, guess: Array) -> list[int] | None:
        """Exact solution of the tight conditions on the guess's support."""
        support = np.flatnonzero(guess > MULTIPLIER_ZERO)
        tight = np.flatnonzero(np.asarray(self.A.T @ guess).ravel() >= -MULTIPLIER_ZERO)
        if max(support.size, tight.size // 4) > LARGEST_VERTEX:
            return None
        columns = conditions_of(self.system).columns
        equations = [columns[j] for j in tight]
        last, shift = integers(self.rows[support])
        system: Integers = np.vstack([block_of(equations, support, guess.size), np.array(last, dtype=object)])
        found = solve_exactly(system, [0] * len(equations) + [1 << shift], guess[support] / self.rows[support])
        if found is None:
            return None
        y = [0] * guess.size
        for j, numerator in zip(support, found[0]):
            y[j] = numerator
        return y

    def nearly(self, guess: Array) -> FloatFarkas | None:
        """The guess with tight conditions solved to round-off, if it is a proof."""
        y = np.where(guess > MULTIPLIER_ZERO, guess, 0.0)
        conditions = Inequalities(transposed(self.A), np.zeros(self.A.shape[1]))
        # One refinement squares the error of 1e-10.
        for _ in range(2):
            terms = row_terms(conditions, y)
            relative = np.where(terms.size > 0.0, terms.w / np.where(terms.size > 0.0, terms.size, 1.0), 0.0)
            error = max(float(relative.max()), 0.0)
            size = float(np.abs(self.q) @ y)
            if size == 0.0:
                return None
            gap = float(self.q @ y) / size
            if error <= PRECISION and gap <= -GAP_IN_DOUBT:
                given = self.system.on_rows(y / self.rows, self.problem.n)
                return FloatFarkas(given / np.abs(given).max(), error, -gap) if given.any() else None
            support, tight = np.flatnonzero(y), np.flatnonzero(np.abs(relative) <= _NEARLY_TIGHT)
            if support.size > LARGEST_REFINED or not tight.size:
                return None
            block = self.A[support][:, tight].T
            block = block.toarray() if sp.issparse(block) else block
            moved = y.copy()
            moved[support] -= y[support] * np.linalg.lstsq(block * y[support], terms.w[tight], rcond=None)[0]
            y = np.maximum(moved, 0.0)
        return None


def multiplier(problem: MixedLCP, y: list[int]) -> Farkas | None:
    """A `Farkas` without common factor, or None if `y` proves nothing."""
    common = gcd(*y) or 1
    y = [value // common for value in y]
    gap = conditions_of(problem).gap(y)
    return None if gap is None or gap >= 0 else Farkas(tuple(y), gap)
