"""Descents of weighted minima: what they lead to is a solution, and they go on where they were."""

import numpy as np
import pytest

from problems import lcp
from problems.lcp import Outcome
from problems.lcp.pivoting.descents import Descents
from problems.lcp.pivoting.programs import cheapest, infeasible_row, point_of, vertex_at_zero


def planted(n, seed):
    r = np.random.default_rng([79, n, seed])
    A, x, w = r.standard_normal((n, n)) / np.sqrt(n), *np.abs(r.standard_normal((2, n)))
    on = r.random(n) < 0.5
    return lcp.LCP(A, np.where(on, 0.0, w) - A @ np.where(on, x, 0.0))


def test_a_vertex_is_feasible_and_least():
    problem = planted(20, 0)
    dictionary = vertex_at_zero(problem, np.ones(20))
    assert infeasible_row(dictionary, np.zeros(41, dtype=bool)) == -1
    x, w = point_of(dictionary)
    np.testing.assert_allclose(problem.w(x), w, atol=1e-10)
    assert min(*x, *w) >= -1e-8
    costs = np.append(np.zeros(20), np.ones(20))
    assert cheapest(dictionary, costs) is not None
    later, w_later = point_of(dictionary)
    np.testing.assert_allclose(problem.w(later), w_later, atol=1e-9)
    assert min(*later, *w_later) >= -1e-8
    assert w_later.sum() <= w.sum() + 1e-8
    empty = vertex_at_zero(lcp.LCP(-np.eye(2), [-1.0, 1.0]), np.ones(2))
    assert infeasible_row(empty, np.zeros(5, dtype=bool)) == 0


def test_they_lead_to_solutions_and_go_on():
    problem, found = planted(30, 4), []
    search = Descents(problem, lambda active: bool(found.append(active)) or len(found) > 1, 0)
    assert not search.run(1)
    assert search.programs == 2
    assert not search.run(1000, seconds=-1.0)
    assert search.run(20_000)
    for active in found:
        x = np.zeros(30)
        x[active] = np.linalg.solve(problem.A[np.ix_(active, active)], -problem.q[active])
        assert np.abs(np.minimum(x, problem.w(x))).max() <= 1e-8
    assert not Descents(lcp.LCP(-np.eye(2), -np.ones(2)), lambda active: True, 0).run(100)


@pytest.mark.parametrize("seed", [0, 1])
def test_solve_takes_them_where_pivots_and_active_sets_fail(seed):
    found = lcp.solve(planted(70, seed), seed=seed)
    assert found.outcome is Outcome.SOLVED
    again = lcp.solve(planted(70, seed), seed=seed)
    assert found.message == again.message
    np.testing.assert_array_equal(found.x, again.x)
