"""Where the paper's guarantees fail: counterexamples found, shrunk and in closed form, and the exact class instead."""

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, find, given, settings
from hypothesis import strategies as st
from hypothesis.errors import NoSuchExample

from continuation import Kind, Status, trace
from problems.lcp import LCP, KKTHomotopy, Outcome, certify, solve, solve_by_enumeration
from problems.lcp.classes import is_n, is_nondegenerate, is_p0, is_row_sufficient
from problems.lcp.strategies import feasible_lcps, matrices

from ...exact import fractions
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
    exact, vector, wrong = fractions(A), np.array(membership.certificate.vector, dtype=object), 0
    for v in (vector, -vector):
        u = exact.T @ v
        x, z2, w, z1 = np.maximum(v, 0), np.maximum(-v, 0), np.maximum(-u, 0), np.maximum(u, 0)
        assert not ((exact + exact.T) @ x + w - exact @ x - z1 - exact.T @ z2).any()
        assert not np.append(z1 * x, z2 * w).any()
        wrong += (x * w).any()
    assert wrong


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
