"""`solutions`: several or all solutions of a problem."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from attrs import define, evolve, field, frozen

from continuation.arguments.checks import check_flag
from continuation.arrays import SIX_DIGITS, Array
from continuation.budget import Budget
from continuation.counts import Counts
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.iteration import Policy
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, MixedLCP, require_problem
from problems.lcp.parametric.along import along
from problems.lcp.parametric.corner import LARGEST_LISTED
from problems.lcp.parametric.stairs import Stairs
from problems.lcp.proof.certificate import Certificate, certify
from problems.lcp.proof.verdict import confirmed
from problems.lcp.reference.enumeration import decidable, solve_by_enumeration
from problems.lcp.search.solver import solve
from problems.options import check_budget, check_seed, check_tolerance

IN_VAIN = 30
"""The search ends after so many directions in a row without a new solution, and twice the number found."""

CORNERS_A_PATH = 50
"""Longest path, in kinks per unknown."""


@frozen(eq=False)
class Solutions:
    """The solutions in order found; iteration gives certificates.

    Attributes
    ----------
    problem : MixedLCP
    certificates : tuple of Certificate
    complete : bool
        Whether these are all solutions, by an exact test.
    paths : int
        Traced.
    message : str
    """

    problem: MixedLCP
    certificates: tuple[Certificate, ...]
    complete: bool
    paths: int
    message: str

    def __len__(self) -> int:
        return len(self.certificates)

    def __iter__(self) -> Iterator[Certificate]:
        return iter(self.certificates)

    def __repr__(self) -> str:
        return f"<Solutions: {len(self)}, {'all there are' if self.complete else 'perhaps not all'}>"

    @property
    def points(self) -> Array:
        """The solutions x, shape (number, n)."""
        return np.array([one.x for one in self.certificates]).reshape(-1, self.problem.n)


def solutions(
    problem: MixedLCP,
    *,
    enumerate_faces: bool = True,
    seed: int = 0,
    budget: Budget | None = None,
    tolerance: float = 1e-10,
) -> Solutions:
    """Find several solutions of an LCP(q, A), with or without bounds.

    Up to order ten each complementary face of an LCP is solved exactly, which finds all solutions, unless a face holds
    a continuum. Otherwise paths of q + t d, for random d, start from the solution of `solve` and from those found; each
    crossing of t = 0 is a solution.

    Parameters
    ----------
    problem : LCP or MixedLCP
    enumerate_faces : bool
        Whether to try all faces.
    seed : int
        Seed of the directions d.
    budget : continuation.Budget, optional
        Its steps limit the kinks of all paths, by default 200,000.
    tolerance : float
        As for `solve`.

    References
    ----------
    Cottle, Pang and Stone, section 4.5; for games, Shapley, Math. Programming Study 1, 1974.
    """
    require_problem(problem)
    check_tolerance(tolerance)
    check_seed(seed)
    check_budget(budget)
    check_flag("enumerate_faces", enumerate_faces)
    if isinstance(problem, LCP) and enumerate_faces and decidable(problem, LARGEST_LISTED):
        return _on_faces(problem, tolerance)
    search = _Search(Structure(problem), tolerance, np.random.default_rng(seed), budget or Budget(steps=200_000))
    first = solve(problem, tolerance=tolerance, seed=seed)
    if not first.solved or first.x is None:
        return Solutions(problem, (), False, 0, f"No path has begun. {first.message}")
    search.take(first.x)
    ended = search.run()
    message = f"{len(search.found)} found on {search.paths} paths (seed {seed}), which tell of no others. {ended}"
    return Solutions(problem, tuple(search.found), False, search.paths, message)


def _on_faces(problem: LCP, tolerance: float) -> Solutions:
    tried = solve_by_enumeration(problem)
    certificates = [certify(problem, one.point) for one in tried.solutions]
    certified = tuple(one for one in certificates if confirmed(problem, one, tolerance))
    complete = tried.complete and len(certified) == len(certificates)
    message = f"All {2**problem.n} complementary faces were tried in exact arithmetic."
    if not tried.complete:
        message += " Some hold a continuum of solutions, of which there is one at least."
    elif not complete:
        message += f" {len(certificates) - len(certified)} of the solutions are none once rounded to floats."
    return Solutions(problem, certified, complete, 0, message)


@define(eq=False)
class _Search:
    structure: Structure
    tolerance: float
    random: np.random.Generator
    budget: Budget
    found: list[Certificate] = field(factory=list)
    paths: int = 0
    counts: Counts = field(factory=Counts)

    @property
    def problem(self) -> MixedLCP:
        return self.structure.problem

    def take(self, x: Array) -> bool:
        if self._known(x):
            return False
        # A piece's equations are more accurate than interpolation.
        finish = Finish(Faces(self.structure), self.tolerance)
        piece = Stairs.of(self.problem, np.zeros(x.size)).states(self.problem, x)
        solved = finish.settle(piece, Policy(steps=0), x)
        solved = finish.take(x) if solved is None else solved
        if solved is None or finish.certificate is None or self._known(solved):
            return False
        self.found.append(finish.certificate)
        return True

    def _known(self, x: Array) -> bool:
        size = SIX_DIGITS * float(np.abs(x).max(initial=0.0))
        return any(float(np.abs(x - one.x).max(initial=0.0)) <= size for one in self.found)

    def run(self) -> str:
        """Follow paths from all solutions; return why the search ended."""
        n, in_vain, tried = self.problem.n, 0, 0
        while in_vain < max(IN_VAIN, 2 * len(self.found)):
            left = self.budget.steps - self.counts.accepted
            if left <= 0:
                return f"The budget is used up: {self.budget.steps:g} steps."
            d = self.random.standard_normal(n)
            start = self.found[tried % len(self.found)].x
            tried += 1
            new = 0
            for end in (math.inf, -math.inf):
                few = evolve(self.budget, steps=max(min(left, CORNERS_A_PATH * n), 2))
                path = along(self.problem, d, (0.0, end), x=start, budget=few)
                self.paths += 1
                self.counts = self.counts + path.counts
                new += sum(self.take(u[:n]) for u in path.crossings(0.0)[1:])
            in_vain = 0 if new else in_vain + 1
        return f"The last {in_vain} directions found nothing new."
