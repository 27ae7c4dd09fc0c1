"""What is tried before a search, and before more than one singular face: what it saves, and that nothing is lost."""

import numpy as np
import pytest
import scipy.sparse as sp

from problems import lcp
from problems.lcp import LCP
from problems.lcp.active_set.face import Faces
from problems.lcp.search import exclusion
from problems.lcp.search.active_sets import SETTLED
from problems.lcp.search.pivots import Pivots
from problems.scenes.planar import free_motion, time_step

from ....util import benchmark
from ..util import solution_of


@pytest.fixture
def made(monkeypatch):
    """The active sets of the faces that were factored."""
    states, make = [], Faces.face

    def counted(self, state, *rest):
        states.append(state.tobytes())
        return make(self, state, *rest)

    monkeypatch.setattr(Faces, "face", counted)
    return states


def test_a_first_active_set_that_is_right_is_all(made):
    """No search is made."""
    found = solution_of(LCP([[4.0, 1.0, 0.0], [0.0, 3.0, 1.0], [1.0, 0.0, 2.0]], [-1.0, -2.0, 5.0]))
    assert found.message.endswith(SETTLED)
    assert (made, found.counts.factorizations, found.best) == ([], 1, -1)
    assert lcp.certify(found.problem, found.x).relative_residual == found.relative_residual
    # A common factor scales nothing else.
    assert lcp.solve(LCP(2.0**400 * found.problem.A, 2.0**400 * found.problem.q)).message == found.message


def test_a_first_active_set_that_is_wrong_is_factored_once(made):
    r = np.random.default_rng(3)
    M = r.normal(size=(6, 6))
    A, q = M @ M.T + np.triu(M, 1) - np.triu(M, 1).T, r.normal(size=6) - 1.0
    assert lcp.solve(LCP(A, q)).counts.factorizations > 1
    found = lcp.solve(LCP(sp.csr_array(A), q), sparse="superlu")
    assert found.solved
    assert len(made) == len(set(made)) == found.counts.factorizations > 1


def test_the_first_active_set_costs_few_calls():
    """Of functions, of Python and of C, by which the time of a small problem is counted."""
    r = np.random.default_rng(8)
    M = r.normal(size=(8, 8))
    A, q = M @ M.T + 8.0 * np.eye(8), np.where(np.arange(8) < 3, -1.0, 2.0)
    assert SETTLED in lcp.solve(LCP(A, q)).message
    assert benchmark("step.py").calls(lambda: lcp.solve(LCP(A, q))) <= 300


def test_a_tiny_problem_without_solution_costs_no_search(monkeypatch):
    """All faces are excluded together; a vector that proves it infeasible is sought where it is asked for."""
    monkeypatch.setattr(Pivots, "run", lambda *given: pytest.fail("pivots"))
    monkeypatch.setattr(exclusion, "infeasibility", lambda *given: pytest.fail("a proof by pivots"))
    infeasible = LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0])
    feasible = LCP([[1.0, 1.0], [1.0, -1.0]], [-1.0, -2.0])
    for problem in (infeasible, feasible, LCP(2.0**400 * feasible.A, 2.0**400 * feasible.q)):
        found = solution_of(problem, outcome=lcp.Outcome.UNSOLVABLE)
        assert found.problem is problem
        assert (found.exhaustion.faces, found.exhaustion.solvable) == (4, False)
        assert found.farkas.holds(infeasible) if problem is infeasible else found.farkas is None


def test_a_box_on_many_corners_needs_few_factorizations():
    """It has three degrees of freedom: the first face is singular, so that pivots lead to the one that is right."""
    contacts = [(0, -1, float(x), 0.0, 0.0, 1.0) for x in np.linspace(-0.5, 0.5, 8)]
    A, J, inverse = time_step([(1.0, 1.0 / 6.0, 0.0, 0.5)], contacts, 0.5)
    for seed in range(40):
        v = np.random.default_rng(seed).normal(0.0, 0.05, 3) + 0.01 * inverse * [0.0, -9.81, 0.0]
        found = lcp.solve(LCP(A, free_motion(J @ v)))
        assert found.solved
        assert found.counts.factorizations <= 6


def test_contact_goes_to_pivots_after_the_first_face_and_in_any_unit(made):
    """Three boxes on each other: singular faces, but no few degrees of freedom of which each face tells nearly all."""
    bodies = [(1.0, 1.0 / 6.0, 0.0, k + 0.5) for k in range(3)]
    contacts = [(k, k - 1, side, float(k), 0.0, 1.0) for k in range(3) for side in (-0.5, 0.5)]
    A, J, inverse = time_step(bodies, contacts, 0.5)
    v = np.random.default_rng(1).normal(0.0, 0.05, 9) + 0.01 * inverse * np.tile([0.0, -9.81, 0.0], 3)
    q = free_motion(J @ v)
    found, other = lcp.solve(LCP(A, q)), lcp.solve(LCP(2.0**-11 * A, 2.0**-14 * q))
    assert "By Lemke's method" in found.message
    assert len(made) == 2 * found.counts.factorizations == 4
    assert (other.outcome, other.counts) == (found.outcome, found.counts)
    np.testing.assert_array_equal(8.0 * other.x, found.x)


def test_a_singular_block_of_zeros_is_left_alone_in_any_unit():
    """Routes between two pairs of nodes: the first face is that of the times, a block of zeros."""
    R = np.array([[1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    G = np.eye(2)[[0, 0, 1, 1]]
    A, q = np.block([[R @ R.T, -G], [G.T, np.zeros((2, 2))]]), np.array([1.0, 2.0, 3.0, 1.0, -2.0, -1.0])
    x = lcp.solve(LCP(A, q)).x
    for k in (-40, -11, 12):
        np.testing.assert_array_equal(lcp.solve(LCP(2.0**k * A, 2.0**k * q)).x, x)
