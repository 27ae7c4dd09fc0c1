"""`Solver`: one matrix and many q, each begun from what is known."""

import numpy as np
import pytest
import scipy.sparse as sp

from problems import lcp
from problems.lcp.active_set.face import Faces
from problems.lcp.pivoting.dictionary import Dictionary
from problems.scenes.planar import free_motion, impulses, time_step


def definite(n, seed):
    r = np.random.default_rng(seed)
    M, S = r.standard_normal((2, n, n))
    return M @ M.T / n + 0.1 * np.eye(n) + (S - S.T) / n, r


@pytest.mark.parametrize("units", [1.0, 1e-7])
@pytest.mark.parametrize("make", [np.asarray, sp.csr_array])
def test_the_answers_are_those_of_solve(make, units):
    A, r = definite(40, 1)
    solver = lcp.Solver(make(units * A))
    q, drift = r.standard_normal((2, 40))
    for k in range(10):
        found = solver.solve(units * (q + 0.05 * k * drift))
        assert found.solved
        np.testing.assert_allclose(found.x, lcp.solve(lcp.LCP(A, q + 0.05 * k * drift)).x, rtol=1e-9, atol=1e-12)
        np.testing.assert_array_equal(found.problem.q, units * (q + 0.05 * k * drift))


def test_the_last_factors_are_kept(monkeypatch):
    A, r = definite(120, 2)
    q, solver = r.standard_normal(120), lcp.Solver(A)
    solver.solve(q)
    monkeypatch.setattr(Faces, "_dense", lambda *given: pytest.fail("factored again"))
    assert solver.solve(q * 1.001).solved


def test_a_solution_with_zeros_is_a_start():
    A, r = definite(30, 3)
    q = r.standard_normal(30)
    x = lcp.solve(lcp.LCP(A, q)).x
    assert (x == 0.0).any()
    starts = [lcp.Solver(A).solve(q, active=active) for active in (x, x > 0.0, (x > 0.0).tolist())]
    assert {one.counts.factorizations for one in (*starts, lcp.solve(lcp.LCP(A, q), x0=x))} == {1}
    np.testing.assert_allclose([one.x for one in starts], [x] * 3, rtol=1e-12)


def test_what_is_unsolvable_is_said_so():
    solver = lcp.Solver([[0.0, 1.0], [-1.0, 0.0]])
    assert solver.solve([1.0, 1.0]).solved
    assert solver.solve([-1.0, -1.0]).outcome is lcp.Outcome.UNSOLVABLE
    # Pivots begin anew.
    assert "Solved by pivots along a path" in solver.solve([-1.0, 1.0]).message


def test_a_problem_without_unknowns():
    nothing = lcp.LCP(np.zeros((0, 0)), [])
    for found in (lcp.solve(nothing), lcp.Solver(nothing.A).solve([]), lcp.solve(lcp.LCP(sp.csr_array((0, 0)), []))):
        assert found.outcome is lcp.Outcome.SOLVED
        assert (found.x.shape, found.residual, found.best) == ((0,), 0.0, -1)
    assert nothing.natural_residual(np.zeros(0)) == 0.0
    with pytest.raises(ValueError, match="A: expected a square matrix"):
        lcp.LCP([], [])
    with pytest.raises(ValueError, match="archive"):
        lcp.solve(nothing, archive="nothing.h5")


def test_nothing_is_printed_where_a_sparse_face_is_singular(capfd):
    r = np.random.default_rng(7)
    A = sp.random_array((40, 40), density=0.045, rng=r, data_sampler=r.standard_normal).tocsr()
    for _ in range(5):
        lcp.solve(lcp.LCP(A, r.standard_normal(40)), restarts=0, sparse="superlu")
    assert capfd.readouterr() == ("", "")


def test_steps_of_a_stack_take_a_few_pivots_from_the_last_basis(monkeypatch):
    """Boxes on each other, pushed until they slide and tip: half of the contacts are degenerate all the time."""
    pivots, number, h = [], 12, 0.01
    monkeypatch.setattr(Dictionary, "pivot", lambda *a, real=Dictionary.pivot: pivots.append(1) or real(*a))
    contacts = [(k, k - 1, side, float(k), 0.0, 1.0) for k in range(number) for side in (-0.5, 0.5)]
    A, J, inverse = time_step([(1.0, 1.0 / 6.0, 0.0, k + 0.5) for k in range(number)], contacts, 0.5)
    solver, v, per_step = lcp.Solver(A), np.zeros(inverse.size), []
    for k in range(60):
        force = np.tile([0.2 * np.sin(k / 8.0), -9.81, 0.0], number)
        force[-3] += 0.15 * k
        free = v + h * inverse * force
        pivots.clear()
        found = solver.solve(free_motion(J @ free))
        assert found.solved
        per_step.append((found.counts.factorizations, len(pivots)))
        v = free + inverse * (J.T @ impulses(found.x))
    faces, exchanged = np.array(per_step[1:]).T
    assert faces.max() <= 3
    assert exchanged.sum() <= 30
