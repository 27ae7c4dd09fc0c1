"""Active sets: Newton's method on min(x, A x + q), from a guess of where x is positive.

The guess is that of the caller, of coarser problems where A is that of a grid, else where q < 0. Where A may be
singular or indefinite the method is applied to A + shift I, each round from the point of the one before; of a program
it is applied to the augmented Lagrangian, whose pieces do not cycle.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from attrs import define

from continuation.arrays import least
from problems.lcp.active_set.finish import CORRECTIONS_WITHOUT_GAIN, Finish, below_zero
from problems.lcp.active_set.iteration import Ended, Policy
from problems.lcp.active_set.multigrid_guess import guess, suitable
from problems.lcp.active_set.projected import projected_state
from problems.lcp.data.problem import MixedLCP, State, active_state
from problems.lcp.proof.verdict import to_precision
from problems.lcp.search.pivots import LARGEST_TABLE, by_guess, pivotable
from problems.lcp.search.search import Search

FIRST = "The first active set, where q < 0, is right."
SETTLED = "Solved by active sets alone, before any path."
DESCENDED = "Solved by descent of the quadratic function in the box: a point that satisfies its optimality conditions."
AUGMENTED = "By the augmented Lagrangian of the program, before any path."

MOST_Z_STEPS = 1000
"""Corrections for a Z-matrix, of which n are enough: each makes the active set larger until it is right."""

MOST_AUGMENTED = 2000
"""Factorisations of order n for the augmented Lagrangian: 1,500 are needed for QCAPRI, some 100 for most others."""


def guessed(search: Search) -> bool:
    """Whether something is known of where x is positive: by the caller, or by coarser problems."""
    return search.asked.x0 is not None or search.asked.near is not None or suitable(search.structure)


@define(eq=False)
class ActiveSets:
    """The active sets of one problem, each tried once."""

    search: Search

    def run(self, work: float) -> str:
        """Up to so many corrections of each guess; what settled the problem."""
        search, problem = self.search, self.search.problem
        if zero_solves(problem):
            search.accept(problem.near_zero)
            return "q >= 0, so x = 0 is a solution." if problem.standard else "The point nearest to zero is a solution."
        if not (search.finish is None or not problem.standard or problem.sparse or guessed(search)):
            if search.settle(active_state(problem.q < 0.0), Policy(steps=0, regular=True)):
                return FIRST
            # Where the equations of a face are singular, as those of contact are, pivots are quicker.
            if search.finish.ended is Ended.IRREGULAR and pivotable(search) and not search.facts.symmetric:
                return ""
        return next((said for said, found in self._attempts(int(work)) if found), "")

    def _attempts(self, steps: int) -> Iterator[tuple[str, bool]]:
        """What is said, and whether it has led to a solution, of one guess after another."""
        search, problem, asked, finish = self.search, self.search.problem, self.search.asked, self.search.finish
        if finish is None:
            return
        if asked.near is not None:
            state = problem.states(asked.near.x, asked.near.w)
            found = search.settle(state) or (problem.n <= LARGEST_TABLE and by_guess(search, asked.near))
            yield "Solved from the solution of a problem nearby, before any path.", found
        if asked.x0 is not None:
            yield SETTLED, search.settle(problem.states(asked.x0, problem.w(asked.x0)), Policy(steps))
        if suitable(search.structure):
            yield SETTLED, search.settle(guess(problem, finish.faces.factoring, finish.counts), Policy(steps))
        facts = search.facts
        definite = facts.symmetric and not facts.z_matrix and not facts.negative_diagonal
        first = projected_state(problem) if definite and not problem.standard else first_state(search)
        if definite:
            yield SETTLED, search.found(finish.proximal_active_set(first))
        policy = Policy(steps, patience=CORRECTIONS_WITHOUT_GAIN, regular=pivotable(search))
        if facts.z_matrix:
            policy = Policy(min(problem.n, MOST_Z_STEPS))
        yield SETTLED, search.settle(first if finish.following is None else finish.following, policy)
        if not facts.symmetric and search.semidefinite():
            yield "Solved by active sets of A + shift I, before any path.", search.found(finish.proximal_active_set())
        ends = problem.lower, problem.upper
        box = facts.symmetric and all(bool(np.isfinite(end).all()) for end in ends)
        if box:
            yield DESCENDED, search.found(finish.descend(first))
        elif problem.primal and not problem.standard:
            yield AUGMENTED, self._augmented(finish)

    def _augmented(self, finish: Finish) -> bool:
        """Whether the augmented Lagrangian of a program led to a solution, if only to working precision."""
        search, n = self.search, self.search.problem.primal
        below = 0.0 if search.semidefinite() else below_zero(search.problem.A[:n][:, :n])
        found = search.found(finish.augmented(below, MOST_AUGMENTED))
        return found or (finish.nearest is not None and to_precision(search.problem, finish.nearest))


def zero_solves(problem: MixedLCP) -> bool:
    """Whether the point nearest to zero is a solution."""
    return least(problem.q) >= 0.0 if problem.standard else problem.natural_residual(problem.near_zero) == 0.0


def first_state(search: Search) -> State:
    """The state that the point nearest to zero asks for."""
    problem = search.problem
    if not problem.standard:
        return problem.states(problem.near_zero, problem.w(problem.near_zero))
    # Of a sparse Z-matrix, a grid, zeros of q too, which else join one by one (Chandrasekaran's method).
    grid = problem.sparse and search.facts.z_matrix and float(problem.A.diagonal().min()) > 0.0
    return active_state(problem.q <= 0.0 if grid else problem.q < 0.0)
