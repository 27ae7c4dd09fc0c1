"""Active sets: Newton's method on min(x, A x + q).

Descent with A + shift I follows for a symmetric A in a box, the augmented Lagrangian for a convex program.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from attrs import define

from continuation.arrays import least
from problems.lcp.active_set.finish import PATIENCE, Finish, below_zero
from problems.lcp.active_set.iteration import Ended, Policy
from problems.lcp.active_set.multigrid_guess import guess, suitable
from problems.lcp.active_set.projected import projected_state
from problems.lcp.data.problem import MixedLCP, State, active_state
from problems.lcp.proof.verdict import to_precision
from problems.lcp.search.at_once import SETTLED, ZERO
from problems.lcp.search.pivots import by_guess, pivotable
from problems.lcp.search.search import Search

DESCENDED = "Solved by descent of the quadratic function in the box: a point that satisfies its optimality conditions."
AUGMENTED = "By the augmented Lagrangian of the program, before any path."

MOST_Z_STEPS = 1000
"""Most corrections for a Z-matrix, where each enlarges the active set."""

DESCENT_ROUNDS = 200
"""Most rounds of descent in a box."""


@define(eq=False)
class ActiveSets:
    """One problem's active sets."""

    search: Search

    def run(self, work: float) -> str:
        """Correct each guess up to `work` times."""
        search, problem = self.search, self.search.problem
        if zero_solves(problem):
            search.accept(problem.near_zero)
            return ZERO if problem.standard else "The point nearest to zero is a solution."
        if search.finish is None:
            return ""
        return next((said for said, found in self._attempts(search.finish, int(work)) if found), "")

    def _attempts(self, finish: Finish, steps: int) -> Iterator[tuple[str, bool]]:
        search, problem, asked = self.search, self.search.problem, self.search.asked
        if asked.near is not None:
            state = problem.states(asked.near.x, asked.near.w)
            found = search.settle(state) or (pivotable(search) and by_guess(search, asked.near))
            yield "Solved from the solution of a problem nearby, before any path.", found
        if asked.x0 is not None:
            yield SETTLED, search.settle(problem.states(asked.x0, problem.w(asked.x0)), Policy(steps))
        if suitable(search.structure):
            yield SETTLED, search.settle(guess(problem, finish.faces.factoring, finish.counts), Policy(steps))
        first = first_state(search)
        yield SETTLED, search.settle(first, Policy(steps=0, singular=0))
        facts = search.structure  # costs a small solve
        if finish.ended is Ended.SINGULAR and pivotable(search) and not facts.symmetric:
            return
        long = Policy(min(problem.n, MOST_Z_STEPS)) if facts.z_matrix else Policy(steps, PATIENCE)
        yield SETTLED, search.settle(first if finish.following is None else finish.following, long)
        if facts.symmetric and np.isfinite(problem.lower).all() and np.isfinite(problem.upper).all():
            shift = 1.1 * below_zero(problem.A)
            yield DESCENDED, search.found(finish.proximal(first, shift, DESCENT_ROUNDS))
        elif problem.primal and not problem.standard and facts.semidefinite:
            found = search.found(finish.augmented(lambda: search.exhausted))
            yield AUGMENTED, found or (finish.nearest is not None and to_precision(problem, finish.nearest))


def zero_solves(problem: MixedLCP) -> bool:
    """Whether the point nearest to zero is a solution."""
    return least(problem.q) >= 0.0 if problem.standard else problem.natural_residual(problem.near_zero) == 0.0


def first_state(search: Search) -> State:
    """The state at the point nearest to zero, or for a convex function after projected gradient steps."""
    problem = search.problem
    if problem.standard:
        # On a grid where q is zero these join one by one otherwise (Chandrasekaran's method).
        grid = problem.sparse and search.structure.z_matrix and float(problem.A.diagonal().min()) > 0.0
        return active_state(problem.q <= 0.0 if grid else problem.q < 0.0)
    convex = search.structure.symmetric and not search.structure.negative_diagonal
    return projected_state(problem) if convex else problem.states(problem.near_zero, problem.w(problem.near_zero))
