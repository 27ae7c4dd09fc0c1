"""`Solver`: one A and many q, as in time stepping."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from attrs import define, field

from continuation.arrays import Array, Mask, Matrix
from continuation.budget import Budget
from continuation.linear.silence import Silence
from continuation.linear.threads import one_thread
from problems.lcp.active_set.face import Face, Faces
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.iteration import Policy
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, active_state, square_matrix
from problems.lcp.data.scaling import Scaled
from problems.lcp.pivoting.starts import unit_of
from problems.lcp.search.at_once import at_once
from problems.lcp.search.judge import answer, units_of_its_own, unscaled
from problems.lcp.search.outcome import Solution
from problems.lcp.search.pivots import from_nearby, pivotable
from problems.lcp.search.search import Search
from problems.lcp.search.solver import solve
from problems.options import check_tolerance

NEARBY = "Solved by the active set of a problem nearby, corrected."


@define(eq=False)
class Solver:
    """Solves LCP(q, A) for one matrix and one q after another.

    Each q is tried on the given or the previous active set, then by pivots from the previous q, then by `solve`.
    What is known of A is kept.

    Parameters
    ----------
    A : array_like or scipy sparse, shape (n, n)
    tolerance : float, default 1e-10
        See `solve`.

    Raises
    ------
    ValueError
        If A is not a finite square matrix.

    References
    ----------
    Cottle, Pang and Stone, section 4.5 (the parametric problem LCP(q + t d, A)).
    """

    A: Matrix = field(converter=square_matrix)
    tolerance: float = field(default=1e-10, validator=lambda instance, attribute, value: check_tolerance(value))
    _first: LCP | None = field(default=None, init=False)
    _scaled: Scaled | None = field(default=None, init=False)
    _structure: Structure | None = field(default=None, init=False)
    _active: Mask | None = field(default=None, init=False)
    _last: tuple[Array, Mask] | None = field(default=None, init=False)
    _face: Face | None = field(default=None, init=False)

    @one_thread
    def solve(self, q: Any, active: Any = None, **options: Any) -> Solution:
        """Solve LCP(q, A).

        Parameters
        ----------
        q : array_like, shape (n,)
        active : array_like, shape (n,), optional
            Booleans where x may be positive, or a nearby solution. Default: the previous set.
        **options
            For `solve`, if it is needed.

        Raises
        ------
        ValueError
            For bad input, naming the argument.
        """
        problem = LCP(self.A, q) if self._first is None else self._first.with_q(q)
        self._first = self._first or problem
        guess = self._active if active is None else _mask(active, problem.n)
        found = None
        if problem.n:
            with Silence():
                found = self._nearby(problem, guess)
        if found is None:
            found = solve(problem, tolerance=self.tolerance, **options)
        if found.solved and found.x is not None:
            self._active = found.x > 0.0
            # A basis from pivots is regular where that set may be singular.
            self._last = self._last or (problem.q, self._active)
        return found

    def _nearby(self, problem: LCP, guess: Mask | None) -> Solution | None:
        if self._structure is None:
            scaled = units_of_its_own(problem, roughly=True)
            self._scaled = scaled if scaled is not None and scaled.exact else None
            self._structure = Structure(problem if self._scaled is None else self._scaled.problem)
        scaled, current = self._scaled, problem
        if scaled is not None:
            moved = np.ldexp(problem.q, scaled.rows)
            if not np.array_equal(np.ldexp(moved, -scaled.rows), problem.q):
                return None
            assert isinstance(scaled.problem, LCP)
            current = scaled.problem.with_q(moved)
        found = at_once(current, self.tolerance, guess, NEARBY)
        if found is None:
            structure = self._structure.of_same_matrix(current)
            finish = Finish(Faces(structure, kept=self._face), self.tolerance)
            search, message = Search(structure, finish, self.tolerance, Budget(steps=math.inf)), NEARBY
            if not search.settle(active_state(current.q < 0.0 if guess is None else guess), Policy(steps=1)):
                q, basis = self._last or (None, None)
                rows = 0 if scaled is None else scaled.rows
                d = np.full(problem.n, unit_of(current)) if q is None else np.ldexp(q, rows) - current.q
                last = from_nearby(search, d, basis) if pivotable(search) else None
                if last is None:
                    self._last = None
                    return None
                self._last, message = (problem.q, last), "Solved by pivots along a path from a problem nearby."
            self._face = finish.solved_on or self._face
            found = answer(search, message)
        found = found if scaled is None else unscaled(problem, scaled, self.tolerance, found)
        return found if found.solved else None


def _mask(active: Any, n: int) -> Mask:
    given = np.asarray(active)
    if given.shape != (n,) or given.dtype.kind not in "biuf":
        raise ValueError(f"active: expected {n} booleans or numbers, found shape {given.shape} of dtype {given.dtype}")
    mask: Mask = given if given.dtype == bool else given > 0.0
    return mask
