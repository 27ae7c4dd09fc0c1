"""Problems with bounds against enumeration, closed forms and other software; what is claimed is true."""

import itertools

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings

from continuation.archive import open_archive
from problems import lcp
from problems.lcp import Outcome
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.mixed_strategies import mixed_lcps, programs
from problems.lcp.proof.farkas import farkas

from ...util import BOUNDED
from ..util import drawn, solution_of


@settings(max_examples=60)
@given(mixed_lcps(kinds=("box", "fixed")))
def test_a_box_always_holds_a_solution(problem):
    assert lcp.solve(problem).success


@settings(max_examples=40)
@given(programs())
def test_feasible_convex_programs_are_solved_or_proved_unbounded(program):
    solution = lcp.solve(program)
    if not solution.success:
        assert solution.outcome is Outcome.UNSOLVABLE
        assert "the objective falls for ever" in solution.message


def test_the_example_of_pathsolver():
    A = [[0, 0, -1, -1], [0, 0, 1, -2], [1, -1, 2, -2], [1, 2, -2, 4]]
    solution = lcp.solve(lcp.MixedLCP(A, [2, 2, -2, -6], 0, 10))
    np.testing.assert_allclose(solution.x, [2.8, 0.0, 0.8, 1.2], rtol=1e-15, atol=1e-15)
    assert lcp.certify_exactly(solution.problem, solution.x).solves


# Of free unknowns alone there is no w, so that its start y0 is empty.
FREE = lcp.MixedLCP([[2.0, 1.0], [0.0, 1.0]], [1.0, -1.0])


@pytest.mark.parametrize("homotopy", BOUNDED)
@pytest.mark.parametrize("problem", [FREE, *(drawn(np.random.default_rng(seed), 20) for seed in range(3))])
def test_a_path_alone_solves_every_mixture_of_bounds_and_none(homotopy, problem):
    solution = lcp.solve(problem, homotopy, finish=False)
    assert solution.success, solution.message
    np.testing.assert_allclose(solution.x, lcp.solve(problem).x, atol=1e-8)
    assert len(solution.paths) == 1
    made = HOMOTOPIES[homotopy].make(problem)
    np.testing.assert_allclose(made.residual(made.at_solution(lcp.solve(problem).x), 0.0), 0.0, atol=1e-10)


@pytest.mark.parametrize("stored", list(itertools.product((np.asarray, sp.csr_array), repeat=3)))
@pytest.mark.parametrize(("equations", "rows"), [(4, 8), (4, 0), (0, 0)])
def test_multipliers_by_name_satisfy_the_optimality_conditions(stored, equations, rows):
    rng, n = np.random.default_rng(6), 25
    M, G, B = rng.standard_normal((12, n)), rng.standard_normal((rows, n)), rng.standard_normal((equations, n))
    P, c, inside = M.T @ M, rng.standard_normal(n), rng.random(n)
    h = G @ inside + rng.random(rows)
    (as_P, as_G, as_B), constraints = stored, {}
    if rows:
        constraints |= {"G": as_G(G), "h": h, "rows_lower": h - 1.5}
    if equations:
        constraints |= {"A_eq": as_B(B), "b_eq": B @ inside}
    solution = lcp.solve(lcp.from_qp(as_P(P), c, **constraints, lower=0, upper=1))
    x, of_B, of_G, bounds = (solution.named[name] for name in ("x", "equations", "rows", "bounds"))
    np.testing.assert_allclose(P @ x + c, B.T @ of_B + G.T @ of_G + bounds, atol=1e-12)
    np.testing.assert_allclose(np.minimum(of_G, 0.0) * (h - G @ x), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.maximum(of_G, 0.0) * (G @ x - h + 1.5), 0.0, atol=1e-12)
    assert (bounds[x == 0.0] >= 0.0).all()
    assert (bounds[x == 1.0] <= 0.0).all()
    assert solution.objective == pytest.approx(0.5 * x @ P @ x + c @ x)


@pytest.mark.parametrize(
    ("program", "words"),
    [
        (lcp.from_lp([1, 1], [[1, 1]], [-1], lower=0), "The constraints have no common point."),
        (lcp.from_qp([[1, 0], [0, 0]], [0, -1], [[1, 0]], [1]), "the objective falls for ever"),
        (lcp.from_qp(np.eye(2), [0, 0], A_eq=[[1, 2], [2, 4]], b_eq=[1, 3]), ""),
    ],
    ids=["infeasible", "unbounded", "parallel"],
)
def test_infeasible_and_unbounded_programs_are_proved(program, words):
    solution = solution_of(program, outcome=Outcome.UNSOLVABLE)
    assert words in solution.message
    assert solution.farkas.holds(solution.problem)


def test_a_multiplier_of_bounds_is_checked_exactly():
    """0 <= x <= 1 and x >= 2 in a row without bounds' help: y'w is negative over the whole box."""
    problem = lcp.MixedLCP([[0.0, -1.0], [1.0, 0.0]], [0.0, -2.0], [0.0, 0.0], [1.0, np.inf])
    proof = farkas(problem)
    assert proof.holds(problem)
    assert proof.gap == -1 * proof.y[1]
    assert not proof.holds(lcp.MixedLCP(problem.A, problem.q, [0.0, 0.0], [3.0, np.inf]))


def test_an_archive_of_a_problem_with_bounds(tmp_path):
    problem = lcp.MixedLCP([[1.0, 1.0], [-1.0, 1.0]], [-1.0, -1.0], [0.0, -np.inf], [0.5, np.inf])
    solution = lcp.solve(problem, archive=tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        (stored,) = archive
        np.testing.assert_allclose(stored.endpoint.u[:2], solution.x, atol=1e-14)
        np.testing.assert_array_equal(stored.lam, solution.path.lam)


def test_of_a_fixed_unknown_no_start_is_asked_for():
    problem = lcp.MixedLCP(np.eye(2) + 1.0, [-2.0, -2.0], [0.0, 3.0], [1.0, 3.0])
    assert lcp.solve(problem, x0=[0.5, 7.0]).solved


def test_a_minimum_is_not_claimed_of_a_program_that_is_not_convex():
    for P, said in ((-1.0, True), (1.0, False)):
        solution = solution_of(lcp.from_qp([[P]], [0.25], lower=0, upper=1))
        assert ("need not be a minimum" in solution.message) is said
