"""Proofs that an LCP has no feasible point, or no strictly feasible one: multipliers checked in integers.

For y >= 0 with A'y <= 0, every x >= 0 with w = A x + q >= 0 gives 0 <= y'w = (A'y)'x + q'y <= q'y.
So q'y < 0 proves that no x is feasible, hence that the LCP has no solution (Farkas). If q'y = 0 and y is not zero,
then y'w = 0, so no x has x >= 0 and w > 0: F = {x > 0, A x + q > 0} is empty (Motzkin). Both conditions are also
necessary, by the duality theorem.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import gcd

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray
from scipy.optimize import linprog

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import LCP, MixedLCP, require_lcp, require_problem
from problems.lcp.proof.compensated import row_terms
from problems.lcp.proof.inequalities import Conditions, Inequalities, conditions_of, inequalities
from problems.lcp.proof.rational import IntegerRow, Integers, block_of, integers, solve_exactly

HIGHS_TOLERANCE = 1e-10
"""The tightest feasibility tolerance that HiGHS accepts."""
MULTIPLIER_ZERO = 1e-9
"""What HiGHS leaves of zero, with a digit to spare: a scaled condition so near to it is tried as an equation, and a
scaled multiplier no larger is zero."""

PRECISION = 100 * float(np.finfo(float).eps)
"""The relative error of A'y <= 0 that counts as rounding."""
GAP_IN_DOUBT = 1e-6
"""A gap -q'y below this part of |q|'y is too near zero to say infeasible without a proof."""
_NEARLY_TIGHT = 1e-7
"""A condition this close to zero, relative to its terms, is solved as an equation when y is refined,"""
_REFINEMENTS = 4
"""so many times: the program's 1e-10 is squared each time, and the last ones confirm,"""
LARGEST_REFINED = 1500
"""for at most so many multipliers: a least squares solution of that order takes seconds."""
LARGEST_VERTEX = 300
"""The largest order at which a multiplier is made exact by solving its tight equations in rationals."""
AFFORDABLE_VERTEX = 100
"""The same for a proof that nobody asked for: a tenth of a second, where order 300 takes six."""


@frozen(eq=False)
class Farkas:
    """A multiplier y >= 0, y != 0, with A'y <= 0 and q'y <= 0, exactly: checked in integers on the float data.

    With bounds y_i may be negative where x_i has no lower one, and is zero where it has two; see `inequalities`.

    Attributes
    ----------
    y : tuple of n int
        Without a common factor; any positive multiple proves the same.
    gap : Fraction
        q'y exactly, with bounds q'y + sup {(A'y)'x : l <= x <= u}: negative if no feasible point exists, zero if only
        no strictly feasible one.
    """

    y: tuple[int, ...]
    gap: Fraction

    @property
    def no_feasible_point(self) -> bool:
        """Whether {x >= 0, A x + q >= 0} is proved empty, so that the LCP has no solution."""
        return self.gap < 0

    def in_units(self, problem: MixedLCP, rows: NDArray[np.int64]) -> Farkas | None:
        """The multiplier for `problem`, where this one is for the problem whose rows are 2^rows times those of it.

        Parameters
        ----------
        problem : MixedLCP
        rows : ndarray of int, shape (n,)
        """
        least = int(rows.min())
        y = [value << (int(power) - least) for value, power in zip(self.y, rows)]
        return multiplier(problem, y)

    def holds(self, problem: MixedLCP) -> bool:
        """Whether it proves, exactly, that `problem` has no feasible point.

        Parameters
        ----------
        problem : MixedLCP
        """
        return conditions_of(problem).hold(list(self.y), strict=True)


@frozen(eq=False)
class FloatFarkas:
    """A multiplier that proves that there is no feasible point but for rounding: y >= 0, A'y <= 0 nearly, q'y < 0.

    Some matrix whose entries differ from those of A by at most `error`, relatively, has A'y <= 0 exactly, so that its
    LCP is infeasible for every q with q'y < 0.

    Attributes
    ----------
    y : Array of shape (n,)
        Its largest entry is 1.
    error : float
        max_j (A'y)_j / (|A|'y)_j: of the size of the rounding unit.
    gap : float
        -q'y / |q|'y, at least `GAP_IN_DOUBT`: how clearly q'y is negative.
    """

    y: Array
    error: float
    gap: float

    def in_units(self, rows: NDArray[np.int64]) -> FloatFarkas:
        """The multiplier for the problem whose rows are 2^-rows times those of this one.

        Parameters
        ----------
        rows : ndarray of int, shape (n,)
        """
        y = np.ldexp(self.y, rows - int(rows[self.y != 0.0].max()))
        return FloatFarkas(y / np.abs(y).max(), self.error, self.gap)


def farkas(problem: MixedLCP) -> Farkas | None:
    """An exact proof that {x >= 0, A x + q >= 0}, or what bounds put in its place, is empty, or None.

    Parameters
    ----------
    problem : MixedLCP
        Dense or sparse, of any scaling.

    Returns
    -------
    Farkas or None
        None if feasible points exist, and also if no multiplier passed the exact check: never a claim unproved.

    References
    ----------
    Farkas 1902; Cottle, Pang and Stone, Theorem 2.7.9.
    """
    require_problem(problem)
    return _multiplier(problem, strict=True)


def infeasibility(problem: MixedLCP, guess: Array | None = None) -> Farkas | FloatFarkas | None:
    """A proof that {x >= 0, A x + q >= 0} is empty: exact, else to working precision, else None.

    Parameters
    ----------
    problem : MixedLCP
        Dense or sparse, of any scaling and any order. Tight conditions are solved in rationals up to order
        `AFFORDABLE_VERTEX`, while `farkas` takes the seconds that larger ones cost.
    guess : Array of shape (n,), optional
        A multiplier to be tried in place of that program's.
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
    return scaled.exact(guess, True, AFFORDABLE_VERTEX) or scaled.nearly(guess)


def by_linear_program(matrix: Matrix, vector: Array) -> Array | None:
    """The y that minimises q'y subject to A'y <= 0, sum y = 1, y >= 0; None if there is none, or HiGHS gave up.

    `matrix`, of shape (m, k): A. `vector`, of shape (m,): Its q.
    """
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


def empty_interior(problem: LCP) -> Farkas | None:
    """An exact proof that F = {x > 0, A x + q > 0} is empty, or None.

    Parameters
    ----------
    problem : LCP
        Dense or sparse.

    Returns
    -------
    Farkas or None
        Preferably one that proves that no feasible point exists at all (`no_feasible_point`).

    References
    ----------
    Motzkin's transposition theorem; Cottle, Pang and Stone, Theorem 2.7.10.
    """
    require_lcp(problem)
    return _multiplier(problem, strict=False)


def scales(problem: MixedLCP | Inequalities) -> tuple[Array, Array]:
    """Powers of two r, c, shape (n,): the rows of [A, q] over r and then the columns of A over c have maximum 1."""
    size: Matrix = abs(problem.A)
    largest = np.asarray(size.max(axis=1).toarray()).ravel() if problem.sparse else size.max(axis=1)
    rows = _power_of_two(np.maximum(largest, np.abs(problem.q)))
    scaled = sp.diags_array(1.0 / rows) @ size if problem.sparse else size / rows[:, None]
    largest = np.asarray(scaled.max(axis=0).toarray()).ravel() if problem.sparse else scaled.max(axis=0)
    return rows, _power_of_two(largest)


def scaled_data(problem: MixedLCP | Inequalities, rows: Array, columns: Array) -> tuple[Matrix, Array]:
    """A and q with rows over `rows` and columns over `columns`; exact, as both are powers of two."""
    if problem.sparse:
        return sp.diags_array(1.0 / rows) @ problem.A @ sp.diags_array(1.0 / columns), problem.q / rows
    return problem.A / rows[:, None] / columns, problem.q / rows


def _power_of_two(values: Array) -> Array:
    exponents = np.clip(np.frexp(values)[1], -500, 500)
    return np.where(values > 0.0, np.ldexp(1.0, exponents), 1.0)


def _multiplier(problem: MixedLCP, strict: bool) -> Farkas | None:
    scaled = _Scaled.of(problem)
    guess = by_linear_program(scaled.A, scaled.q)
    if guess is None or float(scaled.q @ guess) > (0.0 if strict else GAP_IN_DOUBT):
        return None
    return scaled.exact(guess, strict, LARGEST_VERTEX)


@frozen(eq=False)
class _Scaled:
    """The inequalities of a problem, and the same with rows over `rows`, columns over others, q over a power of two."""

    problem: MixedLCP
    system: Inequalities
    A: Matrix
    q: Array
    rows: Array

    @classmethod
    def of(cls, problem: MixedLCP) -> _Scaled:
        """Of a problem."""
        system = inequalities(problem)
        rows, columns = scales(system)
        matrix, vector = scaled_data(system, rows, columns)
        return cls(problem, system, matrix, vector / _power_of_two(np.abs(vector).max(keepdims=True)), rows)

    def exact(self, guess: Array, strict: bool, largest: int) -> Farkas | None:
        """The first candidate near a scaled guess that passes the check in integers: its floats, or its vertex."""
        # Checked on the data as given, so that nothing the scaling rounds or underflows can matter.
        conditions = conditions_of(self.system)
        for candidate in self._candidates(conditions, guess, largest):
            if conditions.hold(candidate, strict):
                whole = np.array(candidate, dtype=object)
                return multiplier(self.problem, self.system.on_rows(whole, self.problem.n).tolist())
        return None

    def _candidates(self, conditions: Conditions, guess: Array, order: int) -> Iterator[list[int]]:
        # y of the data as given is the scaled one over the row scales.
        weights = integers(self.rows.max() / self.rows)[0]
        yield [value * weight for value, weight in zip(integers(guess / guess.max())[0], weights)]
        slack = np.asarray(self.A.T @ guess).ravel()
        tight = [conditions.columns[j] for j in np.flatnonzero(slack >= -MULTIPLIER_ZERO)]
        for equations in (tight, [*tight, conditions.constant]):
            found = self._vertex(equations, guess, order)
            if found is not None:
                yield found

    def _vertex(self, equations: list[IntegerRow], guess: Array, order: int) -> list[int] | None:
        """The exact y with the support of the guess, of at most that order, on which the equations vanish."""
        support = np.flatnonzero(guess > MULTIPLIER_ZERO)
        if support.size > order or len(equations) > 4 * order:
            return None
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
        """The guess with its tight conditions solved to round-off, if it is a proof to that; y of the data as given."""
        y = np.where(guess > MULTIPLIER_ZERO, guess, 0.0)
        conditions = Inequalities(transposed(self.A), np.zeros(self.A.shape[1]))
        for _ in range(_REFINEMENTS):
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
            # Relative to y, so that small multipliers move little.
            moved[support] -= y[support] * np.linalg.lstsq(block * y[support], terms.w[tight], rcond=None)[0]
            y = np.maximum(moved, 0.0)
        return None


def multiplier(problem: MixedLCP, y: list[int]) -> Farkas | None:
    """The multiplier without a common factor, and its exact gap; None where it proves nothing."""
    common = gcd(*y) or 1
    y = [value // common for value in y]
    gap = conditions_of(problem).gap(y)
    return None if gap is None else Farkas(tuple(y), gap)
