"""What may be claimed of a point: its residual in compensated arithmetic, and on demand an exact rational solution."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import LCP, require_lcp
from problems.lcp.data.scaling import units
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.compensated import Terms, row_terms
from problems.lcp.proof.farkas import Farkas, farkas
from problems.lcp.proof.rational import IntegerRow, Integers, fractions, integer_rows, solve_exactly
from problems.options import finite_vector

__all__ = ["Certificate", "ExactCertificate", "Farkas", "certify", "certify_exactly", "farkas"]

LARGEST_ACTIVE_SET = 400
"""An exact solve of this order takes tens of seconds; its cost grows like n^3 times the digits, which grow like n."""

ROUND_OFF = 64 * float(np.finfo(float).eps)
"""A relative residual below this is what rounding x leaves; refining x in twice the precision reaches it."""

SMALL = 1e-6
"""Relative to the terms of the rows: an x_i and a w_i below this may both be zero in truth."""

DROWNED = 1e-6
"""The most that a row may be off, relative to the largest |q_i| in balanced units, however large its terms are."""


@frozen(eq=False)
class Certificate:
    """How well x solves the LCP, evaluated in twice the working precision.

    Attributes
    ----------
    x, w : Array of shape (n,)
        w is A x + q, correctly rounded unless it cancels beyond 32 digits.
    residual : float
        The natural residual max_i |min(x_i, w_i)|, absolute: it has the units of the problem.
    relative_residual : float
        max_i |min(x_i, w_i)|, each w_i relative to the terms of its row, (|A| |x| + |q|)_i, and each x_i to its largest
        share in the terms of a row. It does not depend on the units of x, of w, or of any row or column. For x >= 0
        whose zeros are exact it is the componentwise backward error: x solves exactly some LCP(q + dq, A + dA) with
        |dq| <= eps |q|, |dA| <= eps |A| for eps = relative_residual, and for no smaller one.
    negative_x, negative_w : float
        max_i max(-x_i, 0) and max_i max(-w_i, 0): zero at a feasible point.
    complementarity : float
        max_i |x_i w_i|.
    drowned : float
        By how much a row is off relative to the largest |q_i|, in balanced units (`problems.lcp.data.scaling`). It is
        large at a point that runs off to infinity along a solution of LCP(0, A), where the relative residual is small.
        Zero where every |min(x_i, w_i)| is far below |q_i|, so that there is no need to ask.

    References
    ----------
    Oettli and Prager, Compatibility of approximate solution of linear equations with given error bounds for
    coefficients and right-hand sides, Numer. Math. 6, 1964.
    """

    x: Array
    w: Array
    residual: float
    relative_residual: float
    negative_x: float
    negative_w: float
    complementarity: float
    drowned: float

    def solves(self, tolerance: float = 1e-10) -> bool:
        """Whether x may be called a solution: its relative residual is small, and q has not drowned in rounding.

        Relative to its terms alone a row would pass at a point that runs off to infinity on a problem without
        solution; so what it is off may not exceed `DROWNED` times q either. The answer is the same in all units.

        Parameters
        ----------
        tolerance : float, default 1e-10
            Of the relative residual.

        Returns
        -------
        bool
        """
        return self.relative_residual <= tolerance and self.drowned <= DROWNED


def certify(problem: LCP, x: Array, zero: float = 0.0) -> Certificate:
    """Evaluate the natural residual and its parts at x with compensated arithmetic.

    Parameters
    ----------
    problem : LCP
        Dense or sparse.
    x : Array of shape (n,)
    zero : float
        Entries of x up to this, in natural units (|q|_inf over the largest row norm of A), are taken for zeros, and
        the certificate is that of the point with zeros there: the end of a path is near a solution whose zeros are
        exact, and a small x_i may be a large part of row i.

    Raises
    ------
    TypeError
        If the problem is none.
    ValueError
        If x is not a finite vector of n numbers.
    """
    require_lcp(problem)
    if problem.n == 0:
        nothing = np.zeros(0)
        return Certificate(nothing, nothing, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    x = finite_vector("x", x, problem.n)
    if zero > 0.0:
        x = np.where(np.abs(x) <= zero * natural_units(problem)[0], 0.0, x)
    terms = row_terms(problem, x)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        w = np.ldexp(terms.w, terms.exponents)
        products = np.where((x == 0.0) | (w == 0.0), 0.0, np.abs(x * w))
        relative = np.where(terms.size > 0.0, terms.w / terms.size, 0.0)
    shares = _shares(terms, x, (x < 0.0) | (relative > ROUND_OFF))
    off = np.abs(np.minimum(shares, relative))
    return Certificate(
        x=x,
        w=w,
        residual=float(np.abs(np.minimum(x, w)).max()),
        relative_residual=float(off.max()),
        negative_x=float(np.maximum(-x, 0.0).max()),
        negative_w=float(np.maximum(-w, 0.0).max()),
        complementarity=float(products.max()),
        drowned=_drowned(problem, terms, off),
    )


def _shares(terms: Terms, x: Array, asked: NDArray[np.bool_]) -> Array:
    """Each x_i with its sign, as its largest share in the terms of a row; infinite where that is not asked.

    An x_i in no row at all can be anything but is zero where w_i > 0: any other is off by all of itself.
    """
    shares = np.where(x == 0.0, 0.0, np.inf)
    indices = np.flatnonzero(asked & (x != 0.0))
    if indices.size:
        inverse = 1.0 / np.where(terms.size > 0.0, terms.size, 1.0)
        sizes = np.abs(terms.x[indices])
        with np.errstate(under="ignore"):
            if sp.issparse(terms.A):
                columns = abs(sp.csr_array(terms.A)[:, indices])
                present = (columns != 0.0).sum(axis=0) > 0
                largest = (sp.diags_array(inverse) @ (columns @ sp.diags_array(sizes))).max(axis=0).toarray().ravel()
            else:
                columns = np.abs(terms.A[:, indices])
                present = (columns > 0.0).any(axis=0)
                largest = (columns * sizes * inverse[:, None]).max(axis=0)
        shares[indices] = np.sign(x[indices]) * np.where(present, largest, 1.0)
    return shares


def _drowned(problem: LCP, terms: Terms, off: Array) -> float:
    """See `Certificate.drowned`; the balanced units are asked for only where a row is off by more than its own q_i."""
    with np.errstate(over="ignore", under="ignore"):
        asked = (off > 0.0) & (off * terms.size > DROWNED * np.abs(np.ldexp(problem.q, -terms.exponents)))
    if not asked.any():
        return 0.0
    rows, _ = units(problem)
    with np.errstate(over="ignore", under="ignore"):
        largest = float(np.ldexp(np.abs(problem.q), rows).max())
        worst = float(np.ldexp((off * terms.size)[asked], (rows + terms.exponents)[asked]).max())
    return worst / largest if largest > 0.0 else 0.0


@frozen(eq=False)
class ExactCertificate:
    """An exact rational point on an active set, the data taken as the exact dyadic rationals that floats are.

    Attributes
    ----------
    solves : bool
        Whether x >= 0, A x + q >= 0 and x_i w_i = 0 hold exactly: a proof, checked in integers.
    x, w : tuple of n Fraction, or None
        None if the active set's equations have no solution.
    active : tuple of int
        The indices with w_i = 0 imposed; x_i = 0 elsewhere.
    message : str
    """

    solves: bool
    x: tuple[Fraction, ...] | None
    w: tuple[Fraction, ...] | None
    active: tuple[int, ...]
    message: str

    @property
    def x_rounded(self) -> Array:
        """The exact x, each entry rounded to the nearest double, shape (n,)."""
        if self.x is None:
            raise ValueError("x: there is no exact point on this active set")
        return np.array([float(value) for value in self.x])


def certify_exactly(problem: LCP, x: Array) -> ExactCertificate:
    """Solve on the active set of x in rational arithmetic and decide exactly whether that solves the LCP.

    The active set is {x_i > w_i}, each relative to the terms of the rows; if its point is not a solution, two more
    are tried, in which the indices that are zero in both x and w, to `SMALL`, are left out or taken in. On a singular
    active set the dependent entries of x keep their float values, so degenerate and rank-deficient problems have
    certificates too.

    Parameters
    ----------
    problem : LCP
        Of any size; its active set is at most `LARGEST_ACTIVE_SET`.
    x : Array of shape (n,)
        An approximate solution.

    Raises
    ------
    ValueError
        If x is not a finite vector of n numbers, or its active set is too large.
    """
    require_lcp(problem)
    x = finite_vector("x", x, problem.n)
    rows = integer_rows(problem.A, problem.q)
    first: ExactCertificate | None = None
    for active in _active_sets(problem, x):
        if active.size > LARGEST_ACTIVE_SET:
            raise ValueError(f"x: expected an active set of at most {LARGEST_ACTIVE_SET} indices, found {active.size}")
        found = _exact_point(problem, rows, active, x)
        if found.solves:
            return found
        first = first or found
    assert first is not None
    return first


def _active_sets(problem: LCP, x: Array) -> list[NDArray[np.intp]]:
    """{x > w} relative to the terms of the rows, then without and with the indices where both are about zero."""
    terms = row_terms(problem, x)
    with np.errstate(invalid="ignore", divide="ignore"):
        w = np.where(terms.size > 0.0, terms.w / terms.size, 0.0)
    x = _shares(terms, x, np.ones(problem.n, dtype=bool))
    doubtful = (np.abs(x) <= SMALL) & (np.abs(w) <= SMALL)
    sets: list[NDArray[np.intp]] = []
    for chosen in (x > w, (x > w) & ~doubtful, (x > w) | doubtful):
        indices = np.flatnonzero(chosen)
        if not any(np.array_equal(indices, other) for other in sets):
            sets.append(indices)
    return sets


def _exact_point(problem: LCP, rows: list[IntegerRow], active: NDArray[np.intp], x: Array) -> ExactCertificate:
    """The exact solution on one active set, and its signs."""
    chosen = tuple(int(i) for i in active)
    right = [-rows[i].constant for i in chosen]
    solution = solve_exactly(_block(rows, active, problem.n), right, x[active])
    if solution is None:
        return ExactCertificate(False, None, None, chosen, "The equations w_i = 0 of the active set are inconsistent.")
    numerators, denominator = [0] * problem.n, solution[1]
    for i, value in zip(chosen, solution[0]):
        numerators[i] = value
    exact_x = fractions(numerators, denominator)
    exact_w = tuple(_fraction_w(row, numerators, denominator) for row in rows)
    if min(numerators) < 0:
        message = f"The exact point of the active set has x[{int(np.argmin(numerators))}] < 0."
        return ExactCertificate(False, exact_x, exact_w, chosen, message)
    if min(exact_w) < 0:
        message = f"The exact point of the active set has w[{exact_w.index(min(exact_w))}] < 0."
        return ExactCertificate(False, exact_x, exact_w, chosen, message)
    return ExactCertificate(True, exact_x, exact_w, chosen, "Solves the LCP exactly, checked in rational arithmetic.")


def _block(rows: list[IntegerRow], active: NDArray[np.intp], n: int) -> Integers:
    """The rows and columns of the active set as Python integers."""
    place = np.full(n, -1)
    place[active] = np.arange(active.size)
    block = np.zeros((active.size, active.size), dtype=object)
    for i, index in enumerate(active):
        for column, value in zip(place[rows[index].columns], rows[index].values):
            if column >= 0:
                block[i, column] = value
    return block


def _fraction_w(row: IntegerRow, numerators: list[int], denominator: int) -> Fraction:
    """W_i exactly; the integer row is a power of two times the float row, and that power is divided out."""
    return Fraction(row.times(numerators, denominator), denominator << row.shift)
