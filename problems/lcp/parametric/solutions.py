"""`solutions`: several or all solutions of a problem."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from attrs import evolve, frozen

from continuation.arguments.checks import check_flag
from continuation.arrays import SIX_DIGITS, Array
from continuation.budget import Budget
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
        """Solutions x, shape (number, n)."""
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
    first = solve(problem, tolerance=tolerance, seed=seed)
    if not first.solved or first.x is None:
        return Solutions(problem, (), False, 0, f"No path has begun. {first.message}")
    found: list[Certificate] = []
    structure, n = Structure(problem), problem.n
    _take(first.x, found, structure, tolerance)
    random, most = np.random.default_rng(seed), budget or Budget(steps=200_000)
    left, paths, tried, in_vain = most.steps, 0, 0, 0
    while left > 0 and in_vain < max(IN_VAIN, 2 * len(found)):
        before, d, start = len(found), random.standard_normal(n), found[tried % len(found)].x
        for end in (math.inf, -math.inf):
            few = evolve(most, steps=max(min(left, CORNERS_A_PATH * n), 2))
            path = along(problem, d, (0.0, end), x=start, budget=few)
            left -= path.counts.accepted
            paths += 1
            for u in path.crossings(0.0)[1:]:
                _take(u[:n], found, structure, tolerance)
        in_vain = 0 if len(found) > before else in_vain + 1
        tried += 1
    ended = f"The last {in_vain} directions found nothing new."
    if left <= 0:
        ended = f"The budget is used up: {most.steps:g} steps."
    message = f"{len(found)} found on {paths} paths (seed {seed}), which tell of no others. {ended}"
    return Solutions(problem, tuple(found), False, paths, message)


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


def _take(x: Array, found: list[Certificate], structure: Structure, tolerance: float) -> None:
    """Add a point if it is a new solution."""
    if _known(x, found):
        return
    # Its piece's equations are more accurate than interpolation.
    finish, problem = Finish(Faces(structure), tolerance), structure.problem
    piece = Stairs.of(problem, np.zeros(x.size)).states(problem, x)
    solved = finish.settle(piece, Policy(steps=0), x)
    solved = finish.take(x) if solved is None else solved
    if solved is not None and finish.certificate is not None and not _known(solved, found):
        found.append(finish.certificate)


def _known(x: Array, found: list[Certificate]) -> bool:
    size = SIX_DIGITS * float(np.abs(x).max(initial=0.0))
    return any(float(np.abs(x - one.x).max(initial=0.0)) <= size for one in found)
