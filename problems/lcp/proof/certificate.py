"""Certificates of points: accurate residuals, exact solutions."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array, finite, largest, least
from continuation.linear.silence import without_warnings
from problems.lcp.data.problem import BETWEEN, LOWER, UPPER, MixedLCP, State, require_problem
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.compensated import Terms, error_bound, row_terms
from problems.lcp.proof.farkas import Farkas, farkas
from problems.lcp.proof.off import DROWNED, drowned_part, shares_in_rows
from problems.lcp.proof.pieces import SMALLEST_NORMAL, drift, inverses
from problems.lcp.proof.rational import IntegerRow, block_of, fractions, integer_rows, integers, solve_exactly
from problems.options import finite_vector

__all__ = ["Certificate", "ExactCertificate", "Farkas", "certify", "certify_exactly", "farkas"]

LARGEST_ACTIVE_SET = 400
"""An exact solve of this order takes tens of seconds."""

ROUND_OFF = 64 * float(np.finfo(float).eps)
"""Smaller relative residuals are round-off."""

BOTH_ZERO = 1e-6
"""Smaller x_i and w_i, relative to the terms, may both be zero."""

MOST_MADE_UP = 2.0**-50
"""2^-1074 times the largest float bounds the effect of a subnormal x_j on a row."""


_quiet = without_warnings(over="ignore", under="ignore", invalid="ignore")


@frozen(eq=False, slots=False)
class Certificate:
    """How well x solves the problem.

    With bounds, |x - mid(l, x - w, u)|_i replaces |min(x_i, w_i)|.

    Attributes
    ----------
    problem : MixedLCP
    x, w : Array of shape (n,)
        w = A x + q, correctly rounded unless 32 digits cancel.
    relative_residual : float
        The residual relative to the terms (|A| |x| + |q|)_i of each row. For x >= 0 with exact zeros it is the
        componentwise backward error: the least eps such that x solves an LCP(q + dq, A + dA) with |dq| <= eps |q|, |dA|
        <= eps |A|.
    drowned : float
        Largest defect of a row relative to max |q_i| in balanced units, zero up to 1e-10. It is large if x runs off to
        infinity along a solution of LCP(0, A), where the relative residual is small.

    References
    ----------
    Oettli and Prager, Numer. Math. 6, 1964.
    """

    problem: MixedLCP = field(repr=False)
    x: Array
    w: Array
    relative_residual: float
    drowned: float
    _terms: Terms | None = field(default=None, repr=False)

    @cached_property
    def exact(self) -> bool:
        """Whether the face of x, or one of two that differ where x_i and w_i are nearly 0, holds an exact solution."""
        return self.clearly_exact or certify_exactly(self.problem, self.x).solves

    @property
    @_quiet
    def clearly_exact(self) -> bool:
        """Whether floats with error bounds prove a solution near x on its face.

        References
        ----------
        Rump, Acta Numerica 19, 2010, section 10.
        """
        problem, x, w, terms = self.problem, self.x, self.w, self._terms
        if terms is None or terms.scaled or least(room := self._room) < 0.0:
            return False
        inside = room.nonzero()[0]
        if not problem.standard:
            w = np.where(problem.fixed, np.inf, np.where(x == problem.lower, w, -w))
        if not x.any():
            return not inside.size and least(w) >= 0.0  # w = q
        clear = w - (bound := error_bound(self.w, terms.size, x.size + 1))
        if inside.size:
            A: Array = problem.A.toarray() if problem.sparse else problem.A
            block, near = A if inside.size == x.size else A[inside][:, inside], np.abs(x[inside])
            left, most = (np.abs(self.w) + bound)[inside], largest(near)
            if least(near) == 0.0:
                return False
            defect, moved = drift(block, inverses(block), near, left, terms.size[inside], most)
            # `largest` passes over what is not finite.
            if not (finite(defect) and finite(moved) and largest(defect) < 0.5 and largest(moved) < 0.2):
                return False
            clear -= 4.0 * largest(moved) * terms.size
            clear[inside] = 1.0 if problem.standard else room[inside] - 4.0 * largest(moved) * near
        return least(clear) > 0.0

    @property
    def _room(self) -> Array:
        x, problem = self.x, self.problem
        return x if problem.standard else np.minimum(x - problem.lower, problem.upper - x)

    @property
    @_quiet
    def residual(self) -> float:
        """max_i |min(x_i, w_i)|, in the problem's units."""
        return float(np.abs(self.problem.natural_map(self.x, self.w)).max(initial=0.0))

    def solves(self, tolerance: float = 1e-10) -> bool:
        """Whether the relative residual and `drowned` are small.

        Parameters
        ----------
        tolerance : float, default 1e-10
            For the relative residual.
        """
        return self.relative_residual <= tolerance and self.drowned <= DROWNED


def certify(problem: MixedLCP, x: Array, zero: float = 0.0) -> Certificate:
    """Evaluate the residuals at x in compensated arithmetic.

    Parameters
    ----------
    problem : MixedLCP
    x : Array of shape (n,)
    zero : float
        Entries this near to a bound, in natural units, are moved there first.

    Raises
    ------
    TypeError
        If `problem` is no problem.
    ValueError
        If x is not a finite vector of n numbers.
    """
    require_problem(problem)
    if problem.n == 0:
        nothing = np.zeros(0)
        return Certificate(problem, nothing, nothing, 0.0, 0.0)
    x = finite_vector("x", x, problem.n)
    if zero > 0.0:
        near = zero * natural_units(problem)[0]
        x = np.where(np.abs(x - problem.lower) <= near, problem.lower, x)
        x = np.where(np.abs(x - problem.upper) <= near, problem.upper, x)
        unbounded = np.isinf(problem.lower) & np.isinf(problem.upper)
        x = np.where(unbounded & (np.abs(x) <= near), 0.0, x)
    return certified(problem, x)


@_quiet
def certified(problem: MixedLCP, x: Array) -> Certificate:
    """Certificate of a finite, immutable x, shape (n,)."""
    terms = row_terms(problem, x)
    relative = terms.w / (terms.size if least(terms.size) > 0.0 else np.where(terms.size > 0.0, terms.size, 1.0))
    # The shares of x in rows matter only where w is off.
    off = np.abs(np.where(x == 0.0, np.minimum(relative, 0.0), relative))
    worst = largest(off)
    if not (problem.standard and worst <= ROUND_OFF and least(x) >= 0.0):
        off = _counted(problem, terms, x, _defects(problem, terms, x, relative))
        worst = largest(off)
    return Certificate(problem, x, terms.whole, worst, drowned_part(problem, terms, off), terms)


def _defects(problem: MixedLCP, terms: Terms, x: Array, relative: Array) -> Array:
    above = x - problem.lower
    shares = shares_in_rows(problem.A, terms, above, (above < 0.0) | (relative > ROUND_OFF))
    if not problem.standard:
        below = problem.upper - x
        asked = (below < 0.0) | (relative < -ROUND_OFF)
        relative = np.maximum(relative, -shares_in_rows(problem.A, terms, below, asked))
    return np.abs(np.minimum(shares, relative))


def _counted(problem: MixedLCP, terms: Terms, x: Array, off: Array) -> Array:
    """Defects; zero where rounding of subnormal x_j explains them."""
    if largest(off) <= ROUND_OFF:
        return off
    asked = (off > ROUND_OFF) & (np.abs(terms.whole) < x.size * MOST_MADE_UP)
    if not asked.any():
        return off
    inward = np.where(x == problem.upper, -terms.w, terms.w)
    away = ((x != problem.lower) & (x != problem.upper)) | (inward <= ROUND_OFF * terms.size)
    sizes, subnormal = abs(problem.A), np.abs(x) < SMALLEST_NORMAL
    asked &= (problem.q == 0.0) & (sizes @ (~subnormal).astype(float) == 0.0)
    reach = sizes @ (subnormal & away).astype(float)
    most = np.ldexp(np.minimum(reach, np.finfo(float).max), -1074 - terms.exponents)
    made_up = asked & (np.abs(terms.w) <= most) & (x >= problem.lower) & (x <= problem.upper)
    return np.where(made_up, 0.0, off)


@frozen(eq=False)
class ExactCertificate:
    """An exact rational point on an active set.

    Attributes
    ----------
    solves : bool
        Whether the point solves the problem exactly.
    x, w : tuple of n Fraction, or None
        None if the equations are inconsistent.
    active : tuple of int
        Indices with w_i = 0 imposed; other x_i are at a bound.
    message : str
    """

    solves: bool
    x: tuple[Fraction, ...] | None
    w: tuple[Fraction, ...] | None
    active: tuple[int, ...]
    message: str

    @property
    def x_rounded(self) -> Array:
        """The exact x, rounded to doubles, shape (n,)."""
        if self.x is None:
            raise ValueError("x: there is no exact point on this active set")
        return np.array([float(value) for value in self.x])


def certify_exactly(problem: MixedLCP, x: Array) -> ExactCertificate:
    """Solve exactly on the active set of x and decide whether this solves the problem.

    The active set is {x_i > w_i}, or with bounds the piece of the natural map. If it fails, indices with both nearly
    zero (`BOTH_ZERO`) are left out, then taken in.

    Parameters
    ----------
    problem : MixedLCP
    x : Array of shape (n,)
        An approximate solution.

    Raises
    ------
    ValueError
        If x is not a finite vector of n numbers, or its active set exceeds `LARGEST_ACTIVE_SET`.
    """
    require_problem(problem)
    x = finite_vector("x", x, problem.n)
    rows = integer_rows(problem.A, problem.q)
    first: ExactCertificate | None = None
    for state in _states(problem, x):
        active = np.flatnonzero(state == BETWEEN)
        if active.size > LARGEST_ACTIVE_SET:
            raise ValueError(f"x: expected an active set of at most {LARGEST_ACTIVE_SET} indices, found {active.size}")
        found = _exact_point(problem, rows, state, x)
        if found.solves:
            return found
        first = first or found
    assert first is not None
    return first


def _states(problem: MixedLCP, x: Array) -> list[State]:
    terms = row_terms(problem, x)
    with np.errstate(invalid="ignore", divide="ignore"):
        w = np.where(terms.size > 0.0, terms.w / terms.size, 0.0)
    every = np.ones(problem.n, dtype=bool)
    above = shares_in_rows(problem.A, terms, x - problem.lower, every)
    below = shares_in_rows(problem.A, terms, problem.upper - x, every)
    nearest = np.where(above <= below, LOWER, UPPER)
    state = np.where(above <= w, LOWER, np.where(below <= -w, UPPER, BETWEEN))
    state = np.where(problem.fixed, LOWER, state)
    doubtful = (np.minimum(np.abs(above), np.abs(below)) <= BOTH_ZERO) & (np.abs(w) <= BOTH_ZERO) & ~problem.fixed
    states: list[State] = []
    for chosen in (state, np.where(doubtful, nearest, state), np.where(doubtful, BETWEEN, state)):
        if not any(np.array_equal(chosen, other) for other in states):
            states.append(chosen)
    return states


def _exact_point(problem: MixedLCP, rows: list[IntegerRow], state: State, x: Array) -> ExactCertificate:
    active = np.flatnonzero(state == BETWEEN)
    chosen = tuple(int(i) for i in active)
    at_bounds, shift = integers(problem.at(state))
    right = [-rows[i].times(at_bounds, 1 << shift) for i in chosen]
    solution = solve_exactly(block_of([rows[i] for i in chosen], active, problem.n) << shift, right, x[active])
    if solution is None:
        return ExactCertificate(False, None, None, chosen, "The equations w_i = 0 of the active set are inconsistent.")
    numerators, denominator = [value * solution[1] for value in at_bounds], solution[1] << shift
    for i, value in zip(chosen, solution[0]):
        numerators[i] = value << shift
    exact_x = fractions(numerators, denominator)
    exact_w = tuple(Fraction(row.times(numerators, denominator), denominator << row.shift) for row in rows)
    if not _right_signs(problem, state, exact_x, exact_w):
        message = "The exact point of the active set violates a bound or the sign of some w_i."
        return ExactCertificate(False, exact_x, exact_w, chosen, message)
    message = f"Solves the {'LCP' if problem.standard else 'problem'} exactly, checked in rational arithmetic."
    return ExactCertificate(True, exact_x, exact_w, chosen, message)


def _right_signs(problem: MixedLCP, state: State, x: tuple[Fraction, ...], w: tuple[Fraction, ...]) -> bool:
    rows = zip(x, w, state.tolist(), problem.lower.tolist(), problem.upper.tolist())
    return all(low <= v <= high and (low == high or s == BETWEEN or -s * r >= 0) for v, r, s, low, high in rows)
