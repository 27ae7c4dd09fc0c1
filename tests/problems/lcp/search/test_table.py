"""The table of methods: what is tried for which problem, and that a method is a row like any other."""

import numpy as np
import pytest
import scipy.sparse as sp
from attrs import evolve

import continuation
from problems import lcp
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import Finish
from problems.lcp.proof.farkas import infeasibility
from problems.lcp.search import exclusion
from problems.lcp.search.search import Asked, Search
from problems.lcp.search.table import AUTOMATIC, NAMED, PATHS, settled_by

INFEASIBLE = lcp.LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0])
GAME = lcp.LCP([[0.0, 1.0], [2.0, 0.0]], [-1.0, -1.0])


def search(problem, **asked):
    structure = lcp.Structure(problem)
    given = {"restarts": 2, **asked}
    return Search(structure, Finish(Faces(structure), 1e-10), 1e-10, continuation.Budget(), Asked(**given))


def tried(one, table):
    """The names of the rows, if none of them settles anything."""
    names = []

    class Noted:
        def __init__(self, name):
            self.name = name

        def run(self, work):
            names.append(self.name)
            return ""

    noted = tuple(evolve(row, method=lambda _, name=row.name: Noted(name)) for row in table)
    assert settled_by(one, noted) == ""
    return names


@pytest.mark.parametrize(
    ("problem", "left_out"),
    [
        (INFEASIBLE, {"reflections", "reflections, further"}),
        (GAME, {"active sets"}),
        (lcp.LCP(np.eye(30) - 2.0, -np.ones(30)), {"all faces"}),
        (lcp.LCP(np.eye(41) - 2.0, -np.ones(41)), {"all faces", "few groups of faces"}),
        (lcp.MixedLCP(np.eye(3) - 2.0, np.ones(3), -np.ones(3), np.ones(3)), {"all faces", "pivots"}),
        (lcp.LCP(sp.eye_array(4000, format="csr") * -1.0, -np.ones(4000)),
         {"all faces", "few groups of faces", "pivots", "reflections", "reflections, further"}),
    ],
)  # fmt: skip
def test_the_order_depends_on_the_problem(problem, left_out):
    expected = [row.name for row in AUTOMATIC if row.name not in left_out]
    assert tried(search(problem), AUTOMATIC) == expected


def test_without_the_finish_and_with_a_path_that_is_wanted_paths_come_first():
    assert tried(search(INFEASIBLE), PATHS)[0] == "paths"
    assert tried(search(INFEASIBLE, restarts=0), NAMED) == ["paths", "root"]


@pytest.mark.parametrize(
    ("problem", "options", "expected"),
    [
        # All faces are excluded at once; the vector is sought where it is asked for.
        (INFEASIBLE, {}, 0),
        (INFEASIBLE, {"homotopy": "kkt"}, 1),
        # Phase I has the proof already.
        (INFEASIBLE, {"homotopy": "zhao"}, 0),
        # The tree's root is the proof.
        (INFEASIBLE, {"path": True}, 0),
        # Scaled: the proof is moved to the problem as given.
        (lcp.LCP([[0.0, 1e9], [-1e-9, 0.0]], [-1e9, -1.0]), {"homotopy": "kkt"}, 1),
    ],
)
def test_a_proof_is_looked_for_once_and_holds_for_the_data_as_given(problem, options, expected, monkeypatch):
    calls = []
    monkeypatch.setattr(exclusion, "infeasibility", lambda *a: calls.append(a) or infeasibility(*a))
    solution = lcp.solve(problem, **options)
    assert solution.outcome is lcp.Outcome.UNSOLVABLE
    y = np.array(solution.farkas.y, dtype=float)
    assert (problem.A.T @ y <= 0.0).all()
    assert problem.q @ y < 0.0
    assert len(calls) == expected


def test_a_sparse_matrix_is_dense_for_paths():
    r = np.random.default_rng(2)
    A = sp.random_array((20, 20), density=0.2, rng=r, data_sampler=r.standard_normal).tocsr()
    problem = lcp.LCP(A, -np.ones(20))
    one = search(problem)
    settled_by(one, PATHS[:1])
    assert not one.problem.sparse
    assert lcp.solve(problem, path=True, restarts=0).problem is problem
