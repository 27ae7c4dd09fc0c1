"""What is tried before a search, and before more than one singular face: what it saves, and that nothing is lost."""

import numpy as np
import pytest

from problems import lcp
from problems.lcp import LCP
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.iteration import Ended, Policy, Tried, iterate
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import active_state
from problems.lcp.search import at_once, strategy

SINGULAR = LCP([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 0.5, 2.0]], [-1.0, -1.0, -1.0])
"""Two contacts where one is enough."""


@pytest.fixture
def made(monkeypatch):
    """The active sets of the faces that were factored."""
    states, make = [], Faces._made

    def counted(self, state, *rest):
        states.append(state.tobytes())
        return make(self, state, *rest)

    monkeypatch.setattr(Faces, "_made", counted)
    return states


def test_a_first_active_set_that_is_right_is_all(made):
    found = lcp.solve(LCP([[4.0, 1.0, 0.0], [0.0, 3.0, 1.0], [1.0, 0.0, 2.0]], [-1.0, -2.0, 5.0]))
    assert found.outcome is lcp.Outcome.SOLVED
    assert found.message == at_once.MESSAGE
    assert (len(made), found.counts.factorizations, found.best) == (1, 1, -1)
    assert lcp.certify(found.problem, found.x).relative_residual == found.relative_residual


def test_a_first_active_set_that_is_wrong_is_factored_once(made, monkeypatch):
    r = np.random.default_rng(3)
    M = r.normal(size=(6, 6))
    problem = LCP(M @ M.T + np.triu(M, 1) - np.triu(M, 1).T, r.normal(size=6) - 1.0)
    found = lcp.solve(problem)
    assert found.solved
    assert len(made) == len(set(made)) == found.counts.factorizations > 1
    made.clear()
    monkeypatch.setattr(at_once, "LARGEST", 0)
    without = lcp.solve(LCP(problem.A, problem.q))
    assert (without.message, without.counts) == (found.message, found.counts)
    assert len(made) == without.counts.factorizations


def test_it_is_not_taken_where_it_is_no_solution():
    faces = Faces(Structure(LCP([[1.0, 2.0], [2.0, 1.0]], [-1.0, -3.0])))
    assert at_once.at_once(Finish(faces, 1e-10)) is None


def test_an_iteration_over_regular_faces_ends_before_a_singular_one_which_may_be_tried_later():
    faces, tried = Faces(Structure(SINGULAR)), Tried()
    state = active_state(SINGULAR.q < 0.0)
    ended = iterate(faces, state, Policy(steps=5, regular=True), tried=tried)
    assert ended.ended is Ended.IRREGULAR
    np.testing.assert_array_equal(ended.state, state)
    assert tried.add(state)
    assert iterate(faces, state, Policy(steps=5)).ended is not Ended.IRREGULAR


def test_where_pivots_fail_active_sets_go_on_from_the_singular_face(monkeypatch):
    monkeypatch.setattr(at_once, "LARGEST", 0)
    assert "Lemke" in lcp.solve(SINGULAR).message
    monkeypatch.setattr(strategy, "by_lemke", lambda search, seed: False)
    found = lcp.solve(LCP(SINGULAR.A, SINGULAR.q))
    assert found.solved
    assert "Solved by active sets alone" in found.message
