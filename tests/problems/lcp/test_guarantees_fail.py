"""Where the paper's guarantees fail: counterexamples found, shrunk and in closed form, and the exact class instead."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, find, given, settings
from hypothesis import strategies as st
from hypothesis.errors import NoSuchExample

from continuation import Kind, Status, trace
from problems.lcp import LCP, KKTHomotopy, Outcome, certify, solve, solve_by_enumeration
from problems.lcp.classes import is_n, is_nondegenerate, is_p0, is_row_sufficient
from problems.lcp.strategies import feasible_lcps, matrices
from problems.paper import COUNTEREXAMPLES

from ...util import for_interior_paths
from .util import x_at_end

HUNT = settings(
    max_examples=2000, derandomize=True, database=None, deadline=None, suppress_health_check=list(HealthCheck)
)


def stationary(pair):
    """Whether the path from z1 = z2 = e arrives at lambda = 0 and its end does not solve the LCP, not even nearly."""
    problem, x0 = pair
    path = trace(KKTHomotopy(problem, x0))
    x = x_at_end(problem, path)
    return path.status is Status.REACHED_TARGET and not certify(problem, x, 1e-3).solves(1e-3)


def unsolvable(pair):
    return not solve_by_enumeration(pair[0]).solvable and stationary(pair)


@pytest.mark.parametrize(
    ("cls", "belongs", "condition", "order"),
    [
        ("P0", is_p0, stationary, 2),
        ("P0", is_p0, unsolvable, 2),
        ("nondegenerate", is_nondegenerate, stationary, 1),
        ("nondegenerate", is_nondegenerate, unsolvable, 2),
        ("N", is_n, stationary, 1),
    ],
)
def test_a_search_refutes_the_theorem(cls, belongs, condition, order):
    """Theorem 3.7 (P0) and 3.9 (nondegenerate): counterexamples of the lowest order there is, in small integers."""
    problem, x0 = find(feasible_lcps(cls, st.integers(1, 2)), condition, settings=HUNT)
    assert problem.n == order
    assert belongs(problem.A).holds
    assert is_row_sufficient(problem.A).holds is False
    assert np.abs(problem.A).max() <= 3
    assert min(x0.min(), problem.w(x0).min()) > 0
    solution = solve(problem, "kkt", x0=x0, finish=False)
    assert solution.outcome is Outcome.STATIONARY
    assert "does not solve the LCP" in solution.message


def test_the_search_finds_nothing_where_the_theorem_holds():
    """The same search can fail: for P0 of order 1, and for row sufficient matrices, there is nothing to find."""
    few = settings(HUNT, max_examples=30)
    for cls, order in (("P0", 1), ("row_sufficient", 2)):
        with pytest.raises(NoSuchExample):
            find(feasible_lcps(cls, order), stationary, settings=few)


@given(matrices())
def test_row_sufficiency_is_the_exact_class(A):
    """Cottle, Pang and Stone, Theorem 3.5.4, the "only if": outside the class a q with a stationary non-solution.

    From v with v_i (A'v)_i <= 0, somewhere < 0: x = v+, z2 = v-, w = (A'v)-, z1 = (A'v)+, q = w - A x, or -v for v.
    """
    membership = is_row_sufficient(A)
    assume(membership.holds is False)
    vector = np.array(membership.certificate.vector, dtype=object)
    exact = np.vectorize(Fraction, otypes=[object])(A)
    wrong = 0
    for v in (vector, -vector):
        u = exact.T @ v
        x, z2, w, z1 = np.maximum(v, 0), np.maximum(-v, 0), np.maximum(-u, 0), np.maximum(u, 0)
        q = w - exact @ x
        assert not ((exact + exact.T) @ x + q - z1 - exact.T @ z2).any()
        assert not (z1 * x).any()
        assert not (z2 * w).any()
        wrong += (x * w).any()
    assert wrong


@for_interior_paths
@pytest.mark.parametrize("counterexample", COUNTEREXAMPLES, ids=lambda c: c.matrix_class)
def test_the_path_of_a_counterexample_ends_where_the_algebra_says(counterexample, preset):
    """P0: (1 + x)(1 + x - x^2) = x at the end, that is x^3 = x + 1; nondegenerate: x = (2, 0), w = (1, 0)."""
    problem = counterexample.problem
    path = trace(KKTHomotopy(problem, counterexample.x0), preset=preset)
    plastic = max(np.roots([1, 0, -1, -1]), key=np.real).real
    x, w, z2 = {"P0": ([plastic, 1], [0, 1], [1 + plastic, 0]), "nondegenerate": ([2, 0], [1, 0], [0, 3])}[
        counterexample.matrix_class
    ]
    assert path.status is Status.REACHED_TARGET
    assert not path.events
    np.testing.assert_allclose(path.endpoint.y[:2], x, rtol=0, atol=1e-9)
    np.testing.assert_allclose(problem.w(path.endpoint.y[:2]), w, rtol=0, atol=1e-9)
    np.testing.assert_allclose(path.endpoint.y[4:], z2, rtol=0, atol=1e-9)
    np.testing.assert_allclose(counterexample.end, x, rtol=0, atol=5e-5)


@pytest.mark.parametrize("counterexample", COUNTEREXAMPLES, ids=lambda c: c.matrix_class)
@pytest.mark.parametrize("name", ["auto", "kkt"])
def test_a_counterexample_is_never_called_solved(counterexample, name):
    """No start and no method can solve it: there is no solution, by brute force; and it is feasible, so no Farkas.

    Paths end at a stationary point, and say so; "auto" goes on to try all faces, and proves that there is none.
    """
    problem = counterexample.problem
    assert not solve_by_enumeration(problem).solvable
    assert (problem.w(counterexample.x0) > 0).all()
    solution = solve(problem, name, restarts=3)
    assert solution.outcome is (Outcome.STATIONARY if name == "kkt" else Outcome.UNSOLVABLE)
    assert solution.residual >= 0.25
    assert solution.farkas is None
    assert (solution.exhaustion is None) == (name == "kkt")
    assert ("does not solve the LCP" in solution.message) == (name == "kkt")


HILL = LCP([[-1]], [2])
"""min x (2 - x): its solutions are 0 and 2, and between them, at x = 1, a maximum, which is stationary too."""


@for_interior_paths
def test_the_start_in_the_middle_meets_a_branch_point_and_ends_on_the_top(preset):
    """Theorem 3.1 holds for almost every start, not for every: from x0 = 1 the path is x = 1, z1 = z2 = lambda.

    On it G = (1 - lam)(2 lam - 2) + lam, which vanishes where 2 lam^2 - 5 lam + 2 = 0: at lam = 1/2, a pitchfork.
    """
    path = trace(KKTHomotopy(HILL, [1.0]), preset=preset)
    (branch,) = path.events
    assert branch.kind == Kind.BRANCH_POINT
    np.testing.assert_allclose(branch.u, [1, 0.5, 0.5, 0.5], atol=1e-7)
    np.testing.assert_allclose(path.y, np.column_stack([np.ones(len(path)), path.lam, path.lam]), atol=1e-12)
    assert path.endpoint.orientation == -branch.orientation == 1
    assert solve(HILL, "kkt", x0=[1.0], finish=False).outcome is Outcome.STATIONARY


@for_interior_paths
@pytest.mark.parametrize("offset", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_start_beside_the_middle_turns_off_to_a_solution(preset, offset, side):
    """The pitchfork unfolded: a turn of width offset^(1/3) towards the solution on its side, followed, not leapt."""
    path = trace(KKTHomotopy(HILL, [1.0 + side * offset]), preset=preset)
    assert path.status is Status.REACHED_TARGET
    assert not path.events
    assert path.endpoint.y[0] == pytest.approx(1.0 + side, abs=1e-8)
    assert (np.sign(path.y[:, 0] - 1.0) == side).all()


@for_interior_paths
@pytest.mark.parametrize("offset", [1e-7, 1e-9, 1e-12])
def test_a_start_nearer_than_the_tolerance_turns_off_or_names_the_branch_point(preset, offset):
    """Where the two arms are as near as the tolerance a leap is possible, and never silent."""
    path = trace(KKTHomotopy(HILL, [1.0 + offset]), preset=preset)
    assert path.status is Status.REACHED_TARGET
    x = path.endpoint.y[0]
    if [event.kind for event in path.events] == [Kind.BRANCH_POINT]:
        assert path.events[0].lam == pytest.approx(0.5, abs=1e-6)
        assert x == pytest.approx(1.0, abs=1e-6)
    else:
        assert not path.events
        assert x == pytest.approx(2.0, abs=1e-8)
