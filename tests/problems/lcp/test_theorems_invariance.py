"""What must not matter (units, order, start) and who must agree (every method, and brute force), one theorem a test."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from continuation import Status, trace
from problems.lcp import LCP, KKTHomotopy, Outcome, WangHomotopy, certify, random_start, solve, solve_by_enumeration
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.strategies import feasible_lcps, lcps

from ...util import path_of, share
from .util import x_at_end

SMALL_ORDERS = st.integers(1, 3)
TWO_VECTOR = [homotopy.make for name, homotopy in HOMOTOPIES.items() if name != "kkt"]


def end(homotopy):
    path = path_of(homotopy)
    return path.endpoint.y[: homotopy.problem.n]


def near(x, y, accuracy=1e-6):
    return np.abs(x - y).max() <= accuracy * (1.0 + np.abs(y).max())


def unique_solution(problem):
    """That of a P-matrix (Cottle, Pang and Stone, Theorem 3.3.7), exact but for its rounding."""
    (solution,) = solve_by_enumeration(problem).solutions
    return solution.point


@share(30)
@given(st.data())
def test_the_paths_do_not_depend_on_the_order_of_the_unknowns(data):
    """Q' A Q, Q' q from Q' x0 has the path Q' x(s) for every permutation Q."""
    problem, x0 = data.draw(feasible_lcps())
    order = np.array(data.draw(st.permutations(range(problem.n))))
    permuted = LCP(problem.A[np.ix_(order, order)], problem.q[order])
    one, other = trace(KKTHomotopy(problem, x0)), trace(KKTHomotopy(permuted, x0[order]))
    assert other.status is one.status
    whole = np.concatenate([order, order + problem.n, order + 2 * problem.n])
    np.testing.assert_allclose(other.endpoint.y, one.endpoint.y[whole], rtol=1e-6, atol=1e-6)
    assert len(other.turning_points) == len(one.turning_points)


@share(25)
@given(lcps("P"), st.integers(0, 2**32 - 1))
@pytest.mark.parametrize("make", [KKTHomotopy, WangHomotopy])
def test_every_start_leads_to_the_unique_solution(make, problem, seed):
    """P-matrices: LCP(q, A) has one solution for every q, and the paths of all starts end there."""
    start = random_start(problem, np.random.default_rng(seed))
    given_start = (start.x0, start.z1, start.z2, start.w0) if make is KKTHomotopy else (start.x0, start.w0)
    assert near(end(make(problem, *given_start)), unique_solution(problem))


@share(30)
@given(lcps("P"), st.sampled_from(("auto", "kkt", "wang", "yu", "xu")))
def test_every_method_of_solve_finds_the_unique_solution(problem, name):
    """The same of `solve` by paths alone, with the methods whose papers claim P-matrices, and Yu's."""
    solution = solve(problem, name, finish=False, tolerance=1e-8)
    assert solution.outcome is Outcome.SOLVED
    assert near(solution.x, unique_solution(problem))


@share(60)
@given(lcps(n=SMALL_ORDERS))
def test_solve_agrees_with_brute_force(problem):
    """Solvable or not, as all 2^n faces say: SOLVED and UNSOLVABLE are never wrong."""
    truth = solve_by_enumeration(problem)
    solution = solve(problem, restarts=2)
    if solution.outcome in (Outcome.SOLVED, Outcome.UNSOLVABLE):
        assert truth.solvable is solution.solved
    if solution.solved and truth.complete:
        assert any(near(solution.x, x) for x in truth.points)


@pytest.mark.parametrize("make", TWO_VECTOR, ids=lambda make: make.__name__)
@share(15)
@given(pair=feasible_lcps(n=SMALL_ORDERS))
def test_an_end_of_the_earlier_homotopies_is_a_solution(make, pair):
    """Yu, Zhao, Xu, Wang, Kojima-Megiddo-Mizuno: at lambda = 0 they ask for y = A x + q, x y = 0 and x, y >= 0."""
    problem, x0 = pair
    path = trace(make(problem, x0))
    if path.status is not Status.REACHED_TARGET:
        # At lambda = 1 Kojima, Megiddo and Mizuno's equations may have a second solution, the others' have none.
        turned = path.status is Status.TURNED_BACK and make is HOMOTOPIES["kmm"].make
        assert turned or path.status is Status.DIVERGED
        return
    x = x_at_end(problem, path)
    assert certify(problem, x, 1e-7).solves(1e-7)
    truth = solve_by_enumeration(problem)
    assert truth.solvable
    assert not truth.complete or any(near(x, point) for point in truth.points)
