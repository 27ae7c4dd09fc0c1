"""Brute force over the complementary faces: closed forms, theorems of existence and uniqueness, exactness."""

from __future__ import annotations

from fractions import Fraction
from operator import itemgetter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from problems.lcp.classes.simplex import at_least, feasible_point
from problems.lcp.data.problem import LCP
from problems.lcp.reference.enumeration import solve_by_enumeration
from problems.lcp.strategies import badly_scaled_lcps, lcps, near_singular_lcps
from problems.paper import EXAMPLES

from ....exact import exact_w, solves

ORDERS = st.integers(1, 4)


def assert_exact(problem, found):
    assert all(solves(problem, s.x) and tuple(exact_w(problem, s.x)) == s.w for s in found.solutions)


SMALLEST = 5e-324
SOLUTIONS = {
    # x (q - x): solutions 0 and q while q >= 0, none once q is below zero by the smallest float.
    "the smallest q": (LCP([[-1]], [SMALLEST]), {(0,): ((),), (Fraction(SMALLEST),): ((0,),)}),
    "no q": (LCP([[-1]], [0]), {(0,): ((), (0,))}),
    "less": (LCP([[-1]], [-SMALLEST]), {}),
    "less, of two": (LCP([[0, 1], [0, 0]], [-1, SMALLEST]), {}),
    # The paper's example 7: the solution is degenerate, and one of its faces has a singular submatrix.
    "example 7": (EXAMPLES[6].problem, {(1, 0, 2, 0): ((0, 2), (0, 2, 3))}),
    "singular faces with one point": (LCP([[0, 0], [-1, -1]], [0, 0]), {(0, 0): ((), (0,), (1,), (0, 1))}),
    "singular, none": (LCP([[0]], [1]), {(0,): ((),)}),
}


@pytest.mark.parametrize(("problem", "solutions"), SOLUTIONS.values(), ids=SOLUTIONS)
def test_all_solutions_with_their_faces(problem, solutions):
    found = solve_by_enumeration(problem)
    assert {solution.x: solution.faces for solution in found.solutions} == solutions
    assert found.complete


@pytest.mark.parametrize(
    ("A", "q"),
    [
        ([[0]], [0]),
        ([[1, 1], [1, 1]], [-1, -1]),
        ([[0, 1], [0, 0]], [-1, 0]),
        ([[0, 0, 0], [0, 0, 0], [0, 0, 1]], [0, 1, -1]),
    ],
    ids=["ray", "segment", "quadrant", "ray and a point"],
)
def test_a_continuum_is_reported_as_incomplete(A, q):
    problem = LCP(A, q)
    found = solve_by_enumeration(problem)
    assert found.solvable
    assert not found.complete
    assert_exact(problem, found)


HARD = [drawn().map(itemgetter(0)) for drawn in (near_singular_lcps, badly_scaled_lcps)]


@given(st.one_of(lcps("any", ORDERS), *HARD))
def test_every_solution_solves_exactly_and_they_are_distinct(problem):
    found = solve_by_enumeration(problem)
    assert_exact(problem, found)
    assert len({s.x for s in found.solutions}) == len(found.solutions)
    assert all(problem.relative_residual(point) < 1e-15 for point in found.points)


@given(lcps("P", ORDERS))
def test_a_p_matrix_has_exactly_one_solution_for_every_q(problem):
    """Samelson, Thrall and Wesler 1958; CPS, theorem 3.3.7."""
    found = solve_by_enumeration(problem)
    assert len(found.solutions) == 1
    assert found.complete


@given(st.sampled_from(("PSD", "Z", "row_sufficient")).flatmap(lambda cls: lcps(cls, ORDERS)))
def test_for_q0_matrices_solvable_means_feasible(problem):
    """PSD, Z and row sufficient matrices are Q0 (CPS, sections 3.1, 3.11 and 3.5); an exact linear program decides."""
    rows = zip(problem.A.astype(int).tolist(), problem.q.astype(int).tolist(), strict=True)
    feasible = feasible_point([at_least(row, -right) for row, right in rows], problem.n) is not None
    assert solve_by_enumeration(problem).solvable == feasible
