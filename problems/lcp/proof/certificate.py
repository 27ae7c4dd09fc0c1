"""What may be claimed of a point: its residual in compensated arithmetic, and on demand an exact rational solution."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.proof.compensated import accurate_w
from problems.lcp.proof.farkas import Farkas, farkas
from problems.lcp.proof.rational import IntegerRow, Integers, fractions, integer_rows, solve_exactly
from problems.options import finite_vector

__all__ = ["Certificate", "ExactCertificate", "Farkas", "certify", "certify_exactly", "farkas"]

LARGEST_ACTIVE_SET = 400
"""An exact solve of this order takes tens of seconds; its cost grows like n^3 times the digits, which grow like n."""

_ROUNDING = 100 * float(np.finfo(float).eps)


ROUNDING = 1e-6
"""The largest residual, in units of 1 + |q|_inf, that the rounding of a large x may excuse."""


@frozen(eq=False)
class Certificate:
    """How well x solves the LCP, evaluated in twice the working precision.

    Attributes
    ----------
    x, w : Array of shape (n,)
        w is A x + q, correctly rounded unless it cancels beyond 32 digits.
    residual : float
        The natural residual max_i |min(x_i, w_i)|.
    relative_residual : float
        residual / (1 + max(|q|_inf, |A|_inf |x|_inf)).
    negative_x, negative_w : float
        max_i max(-x_i, 0) and max_i max(-w_i, 0): zero at a feasible point.
    complementarity : float
        max_i |x_i w_i|.
    attainable : float
        What rounding in x and q may cost the residual by itself, 100 eps max(|q|_inf, |A|_inf |x|_inf).
    data_scale : float
        1 + |q|_inf.
    """

    x: Array
    w: Array
    residual: float
    relative_residual: float
    negative_x: float
    negative_w: float
    complementarity: float
    attainable: float
    data_scale: float

    def solves(self, tolerance: float = 1e-10) -> bool:
        """Whether x may be called a solution: a stricter test than a small relative residual.

        The residual must be at most tolerance (1 + |q|_inf), but for what rounding x costs. Relative to |x| alone
        a point that runs off to infinity along a solution of LCP(0, A) would pass on a problem without solution. For
        the same reason the allowance for rounding, which grows with |x|, never exceeds ROUNDING (1 + |q|_inf).

        Parameters
        ----------
        tolerance : float, default 1e-10

        Returns
        -------
        bool
        """
        allowance = tolerance * self.data_scale + min(self.attainable, ROUNDING * self.data_scale)
        return self.relative_residual <= tolerance and self.residual <= allowance


def certify(problem: LCP, x: Array) -> Certificate:
    """Evaluate the natural residual and its parts at x with compensated arithmetic.

    Parameters
    ----------
    problem : LCP
        Dense or sparse.
    x : Array of shape (n,)

    Raises
    ------
    ValueError
        If x is not a finite vector of n numbers.
    """
    x = finite_vector("x", x, problem.n)
    w, _ = accurate_w(problem, x)
    with np.errstate(over="ignore", invalid="ignore"):
        residual = float(np.abs(np.minimum(x, w)).max())
        products = np.abs(x * w)
        reach = problem.scale(x)
    data_scale = 1.0 + float(np.abs(problem.q).max())
    return Certificate(
        x=x,
        w=w,
        residual=residual,
        relative_residual=residual / reach if np.isfinite(reach) else np.inf,
        negative_x=float(np.maximum(-x, 0.0).max()),
        negative_w=float(np.maximum(-w, 0.0).max()),
        complementarity=float(np.where(x == 0.0, 0.0, products).max()),
        attainable=_ROUNDING * (reach - 1.0) if np.isfinite(reach) else 0.0,
        data_scale=data_scale,
    )


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

    The active set is {x_i > w_i}; if its point is not a solution, two more are tried, in which the indices that
    are zero in both x and w to 1e-6 are left out or taken in. On a singular active set the dependent entries of x
    keep their float values, so degenerate and rank-deficient problems have certificates too.

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
    x = finite_vector("x", x, problem.n)
    w, _ = accurate_w(problem, x)
    rows = integer_rows(problem.A, problem.q)
    first: ExactCertificate | None = None
    for active in _active_sets(problem, x, w):
        if active.size > LARGEST_ACTIVE_SET:
            raise ValueError(f"x: expected an active set of at most {LARGEST_ACTIVE_SET} indices, found {active.size}")
        found = _exact_point(problem, rows, active, x)
        if found.solves:
            return found
        first = first or found
    assert first is not None
    return first


def _active_sets(problem: LCP, x: Array, w: Array) -> list[NDArray[np.intp]]:
    """{x > w}, then without and with the indices whose x and w are both about zero; each set once."""
    small = 1e-6 * (1.0 + min(float(np.abs(x).max()), float(np.abs(problem.q).max())))
    doubtful = (np.abs(x) <= small) & (np.abs(w) <= small)
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
