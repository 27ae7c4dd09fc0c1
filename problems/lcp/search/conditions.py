"""When the attempts of a strategy are tried: what each asks of the case before it may cost anything."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from problems.lcp.active_set.multigrid_guess import suitable
from problems.lcp.search.case import Case
from problems.lcp.search.limits import LARGEST_PROOF, LARGEST_TINY
from problems.lcp.search.pivots import LARGEST_TABLE, convex


def always(case: Case) -> bool:
    """Where it costs nothing, or nothing else may come first."""
    return True


def has_coarser_problems(case: Case) -> bool:
    """Whether the problem is that of a grid, with coarser ones."""
    return case.search.finish is not None and suitable(case.search.structure)


def monotone(case: Case) -> bool:
    """Whether A is positive semidefinite and not symmetric."""
    return case.semidefinite and not case.known.symmetric


def wang_may_do(case: Case) -> bool:
    """With some a_ii < 0 the matrix is not copositive, and Wang's path mostly diverges; in a box it cannot."""
    return not case.problem.standard or not case.known.negative_diagonal


def stopped(case: Case) -> bool:
    """Whether active sets were given up before their time."""
    return case.search.finish is not None and case.search.finish.stopped is not None


def pivotable(case: Case) -> bool:
    """Where the pure path is not asked for, and a table of n^2 numbers is no burden."""
    if not case.problem.standard or not case.in_budget or case.search.finish is None:
        return False
    return case.problem.n <= LARGEST_TABLE or convex(case.search.structure)


def reflectable(case: Case) -> bool:
    """Where projections are no burden, and nothing is known to end pivots at a solution or a proof."""
    usable = case.in_budget and case.search.finish is not None and case.problem.n <= LARGEST_TABLE
    return usable and not case.known.semidefinite


def game_perhaps(case: Case) -> bool:
    """Where A >= 0, as that of a bimatrix game."""
    return pivotable(case) and case.known.nonnegative


def as_given(when: Callable[[Case], bool]) -> Callable[[Case], bool]:
    """Where entries are alike pivots are tried in the units given, which take less time than others to be found."""
    return lambda case: case.search.postponed and when(case)


def scaled(when: Callable[[Case], bool]) -> Callable[[Case], bool]:
    """Else in units of the problem's own, once."""
    return lambda case: not case.pivoted and when(case)


def near(case: Case) -> bool:
    """Where a guess may be followed."""
    return case.guess is not None and case.problem.n <= LARGEST_TABLE and case.search.finish is not None


def provable(case: Case) -> bool:
    """Where a linear program takes no longer than a few seconds, or the time is limited."""
    n, A = case.problem.n, case.problem.A
    entries = A.nnz if case.problem.sparse else n * n
    return bool(n * entries <= LARGEST_PROOF or case.search.seconds_left < math.inf)


def zero_solves(case: Case) -> bool:
    """Whether the point nearest to zero is a solution."""
    if case.problem.standard:
        return bool(case.problem.q.min() >= 0.0)
    return case.problem.natural_residual(case.problem.near_zero) == 0.0


def in_a_box(case: Case) -> bool:
    """Whether the problem is that of the KKT points of a quadratic function, which a box always has."""
    ends = case.problem.lower, case.problem.upper
    return case.known.symmetric and all(bool(np.isfinite(end).all()) for end in ends)


def with_rows(case: Case) -> bool:
    """Whether the problem is that of a program which is not one in a box alone."""
    return case.problem.primal > 0 and case.in_budget and not in_a_box(case)


def tiny(case: Case) -> bool:
    """Where a proof takes less time than units of the problem's own."""
    return case.pivoted and case.problem.n <= LARGEST_TINY
