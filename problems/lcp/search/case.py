"""What the attempts of a strategy share: the search, the arguments, and what has been found out about the matrix."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor

import numpy as np
from attrs import define, field

from continuation.arrays import Array
from continuation.linear.factoring import Factoring
from problems.lcp.active_set.projected import projected_state
from problems.lcp.data.matrix_facts import MatrixFacts, entry_facts, matrix_facts
from problems.lcp.data.problem import LCP, MixedLCP, State, active_state
from problems.lcp.proof.certificate import certify
from problems.lcp.reference.branching import Branching
from problems.lcp.search.limits import LARGEST_SINGULAR, LEAST_REGULAR, LEAST_SINGULAR
from problems.lcp.search.pivots import AT_END, Nearby, independent
from problems.lcp.search.reflections import Reflections
from problems.lcp.search.search import Search


@define(eq=False)
class Case:
    """What attempts may use and ask.

    Attributes
    ----------
    search : Search
        What is found goes there.
    x0 : Array or None
        A start, in the units of the search.
    asked : str
        The homotopy of the paths for which the strategy names none.
    restarts, seed : int
    executor : Executor or None
    guess : Nearby or None
        The solution of a problem nearby, in the units of the search.
    facts : MatrixFacts or None
        What has been found out about the matrix by now.
    pivoted : bool
        Whether Lemke's method was tried.
    proof_sought : bool
        Whether a proof was looked for.
    followed : str
        The homotopy of the last path but for restarts.
    tried : int
        How many restarts were begun.
    branching : Branching or None
        The tree of the implicit enumeration, once that has begun.
    reflections : iterator or None
        The search by reflections, once that has begun.
    reason : str
        Why there is no start.
    """

    search: Search
    x0: Array | None
    asked: str
    restarts: int
    seed: int
    executor: Executor | None
    guess: Nearby | None = None
    facts: MatrixFacts | None = field(default=None, init=False)
    pivoted: bool = field(default=False, init=False)
    proof_sought: bool = field(default=False, init=False)
    followed: str = field(default="", init=False)
    tried: int = field(default=0, init=False)
    branching: Branching | None = field(default=None, init=False)
    reflections: Iterator[tuple[int, list[State]]] | None = field(default=None, init=False)
    reason: str = field(default="", init=False)

    @property
    def problem(self) -> MixedLCP:
        """The problem in the units of the search."""
        return self.search.problem

    @property
    def factoring(self) -> Factoring:
        """Of sparse faces, with its account."""
        assert self.search.finish is not None
        return self.search.finish.faces.factoring

    @property
    def known(self) -> MatrixFacts:
        """What the entries of the matrix tell, at least."""
        if self.facts is None:
            self.facts = entry_facts(self.search.structure)
        return self.facts

    @property
    def first_state(self) -> State:
        """The state that the point nearest to zero asks for; after a few gradients where A may be definite."""
        if self.problem.standard:
            # Of a sparse Z-matrix, a grid, zeros of q too, which else join one by one (Chandrasekaran's method).
            grid = self.problem.sparse and self.known.z_matrix and float(self.problem.A.diagonal().min()) > 0.0
            return active_state(self.problem.q <= 0.0 if grid else self.problem.q < 0.0)
        if self.definite_perhaps:
            return projected_state(self.problem)
        x = self.problem.near_zero
        return self.problem.states(x, self.problem.w(x))

    @property
    def definite_perhaps(self) -> bool:
        """Whether A is symmetric, nothing that is known excludes that it is definite, and it is no Z-matrix."""
        return self.known.symmetric and not self.known.z_matrix and not self.known.negative_diagonal

    @property
    def contact_perhaps(self) -> bool:
        """Whether faces are singular, as those of contact and constraints, so that pivots are quicker than these.

        But not all is singular, as with one box on many corners.
        """
        known, problem = self.known, self.problem
        if not LEAST_SINGULAR <= problem.n <= LARGEST_SINGULAR or known.z_matrix or known.negative_diagonal:
            return False
        if not isinstance(problem, LCP) or problem.sparse:
            return False
        share = 1.0 if self.search.looked else independent(problem)
        return (share < 1.0 or not problem.A.diagonal().all()) and (known.symmetric or share >= LEAST_REGULAR)

    @property
    def semidefinite(self) -> bool:
        """Whether A is known to be positive semidefinite: costs a factorisation."""
        if self.known.semidefinite is None:
            self.facts = matrix_facts(self.search.structure, self.known)
        return bool(self.known.semidefinite)

    @property
    def compiled(self) -> str:
        """What is said of pivots that numba has compiled."""
        return " (pivots compiled by numba)" if self.search.compiled else ""

    @property
    def hurried(self) -> bool:
        """Whether restarts are to have time after a path that is not asked for, nor made of the caller's parts."""
        return self.restarts > 0 and self.search.finish is not None and not self.search.options

    @property
    def in_budget(self) -> bool:
        """Whether some of the budget is left."""
        return not self.search.exhausted

    def groupable(self, tree: tuple[int, int]) -> bool:
        """Whether faces can be enumerated in groups: of an LCP no entry of which was rounded.

        Parameters
        ----------
        tree : tuple of int
            Its largest order, and how many linear programs it may take.
        """
        search, problem = self.search, self.problem
        if search.finish is None or not isinstance(problem, LCP) or problem.sparse or problem.n > tree[0]:
            return False
        return (search.scaled is None or search.scaled.exact) and self.in_budget

    def branch(self, tree: tuple[int, int]) -> bool:
        """Begin that enumeration, or go on with it; whether it decided the problem.

        Parameters
        ----------
        tree : tuple of int
        """
        search, problem = self.search, self.problem
        if self.branching is None:
            assert isinstance(problem, LCP)
            self.branching = Branching(problem, lambda active: search.settle(active_state(active), AT_END))
        found = self.branching.run(tree[1], search.seconds_left)
        if found is None:
            return self.branching.accepted
        search.exhaustion = found
        if found.point is not None and np.isfinite(found.point).all():
            search.accept(certify(problem, found.point))
        return True

    def reflect(self, rounds: int, share: float) -> bool:
        """Begin the search by reflections, or go on with it; whether it solved the problem.

        Parameters
        ----------
        rounds : int
            Of runs, from the first on.
        share : float
            Of the time left.
        """
        search = self.search
        end = search.seconds + share * search.seconds_left
        if self.reflections is None:
            sets = Reflections.of(self.problem)
            self.reflections = iter(()) if sets is None else sets.rounds(np.random.default_rng(self.seed))
        for over, faces in self.reflections:
            if any(search.settle(face, AT_END) for face in faces):
                return True
            if over >= rounds or search.exhausted or search.seconds > end:
                return False
        return False
