"""Pivoting: paths from basis to basis against an independent Lemke, against closed forms, and through ties."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from problems import lcp
from problems.lcp import LCP
from problems.lcp.pivoting.almost import Ended
from problems.lcp.pivoting.dictionary import Dictionary
from problems.lcp.pivoting.starts import Game, covering
from problems.lcp.search.pivots import constraints
from problems.lcp.strategies import lcps

from ....util import share
from ..util import on_face


@share(400)
@given(st.sampled_from(("any", "P")), st.data())
def test_pivots_end_at_a_solution_or_on_a_ray(cls, data):
    """Integers so small that they make ties; P-matrices have no ray."""
    problem = data.draw(lcps(cls, st.integers(1, 8)))
    path = covering(problem, np.ones(problem.n))
    if path.run(1000) is Ended.REACHED:
        assert problem.natural_residual(on_face(problem, path.active)) < 1e-9
    else:
        assert (path.ended, cls) == (Ended.RAY, "any")


def test_a_singular_basis_is_noticed():
    one = Dictionary(np.array([[1.0, 1.0, 1.0], [1.0, 1.0, 2.0]]), np.arange(2), np.arange(2, 4))
    one.basic, one.nonbasic = np.array([2, 3]), np.array([0, 1])
    assert np.isnan(one.rebuilt())


def test_from_the_solution_for_another_q():
    r = np.random.default_rng(5)
    M = r.standard_normal((30, 30))
    A = M @ M.T / 30 + 0.1 * np.eye(30)
    before, now = r.standard_normal((2, 30))
    active = lcp.solve(LCP(A, before)).x > 0.0
    path = covering(LCP(A, now), before - now, active)
    assert path.run(200) is Ended.REACHED
    assert LCP(A, now).natural_residual(on_face(LCP(A, now), path.active)) < 1e-12
    # Where nothing changes there is nothing to do; from what is no solution there is no path.
    assert covering(LCP(A, before), np.zeros(30), active).ended is Ended.REACHED
    assert covering(LCP(A, now), before - now, ~active) is None


def test_lemke_and_howson_from_every_label():
    # Bach and Stravinsky: two pure equilibria and a mixed one.
    C, D = 3.0 - np.array([[2.0, 0.0], [0.0, 1.0]]), 3.0 - np.array([[1.0, 0.0], [0.0, 2.0]])
    game = Game.of(LCP(np.block([[np.zeros((2, 2)), C], [D.T, np.zeros((2, 2))]]), -np.ones(4)))
    assert game.actions == 2
    paths = [game.path(label) for label in range(4)]
    assert {path.run(50) for path in paths} == {Ended.REACHED}
    assert {tuple(path.active) for path in paths} == {(True, False, True, False), (False, True, False, True)}


def test_a_bounded_program_has_no_other_ray():
    r, n = np.random.default_rng(8), 12
    Q = r.integers(-50, 51, (n, n)).astype(float)
    Q = Q + Q.T
    np.fill_diagonal(Q, -7.0)
    A = np.block([[Q, np.eye(n)], [-np.eye(n), np.zeros((n, n))]])
    problem = LCP(A, np.append(r.integers(-50, 51, n), np.ones(n)))
    np.testing.assert_array_equal(constraints(problem), np.arange(2 * n) >= n)
    for d in 10.0 ** r.uniform(-3.0, 0.0, (20, 2 * n)):
        assert covering(problem, np.where(constraints(problem), 0.0, d)).run(2000) is Ended.REACHED
    assert covering(problem, np.ones(2 * n)).run(2000) is Ended.RAY


def test_the_ray_of_a_semidefinite_matrix_proves_that_nothing_is_feasible():
    r = np.random.default_rng(4)
    y = r.uniform(0.5, 1.5, 20)
    basis = np.linalg.qr(np.column_stack([y, r.standard_normal((20, 19))]))[0][:, 1:]
    A = basis @ np.diag(r.uniform(0.5, 2.0, 19)) @ basis.T
    q = r.standard_normal(20)
    q -= y * (q @ y + 1.0) / (y @ y)
    found = lcp.solve(LCP((A + A.T) / 2.0, q))
    assert found.outcome is lcp.Outcome.INFEASIBLE_TO_PRECISION
    assert "Lemke" in found.message
    np.testing.assert_allclose(found.float_farkas.y, y / y.max(), rtol=1e-9)
