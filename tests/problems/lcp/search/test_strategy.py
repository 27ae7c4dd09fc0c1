"""The order of attempts: what is tried for which problem, and that an attempt is an entry like any other."""

import numpy as np
import pytest
import scipy.sparse as sp
from attrs import evolve

import continuation
from problems import lcp
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import Finish
from problems.lcp.proof.farkas import infeasibility
from problems.lcp.search import strategy
from problems.lcp.search.search import Search
from problems.lcp.search.strategy import AUTOMATIC, NAMED, PATHS, Attempt, Case, settled_by

INFEASIBLE = lcp.LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0])
ZERO = "active sets, from x = 0"
FACES = "groups of faces", "all faces"


def case(problem, **changes):
    structure = lcp.Structure(problem)
    search = Search(structure, Finish(Faces(structure), 1e-10), 1e-10, continuation.Budget(), None, False, {})
    asked = {"x0": None, "asked": "kkt", "restarts": 2, "seed": 0, "executor": None} | changes
    return Case(search, **asked)


def tried(one, order):
    """The names of the attempts, if none of them settles anything."""
    names = []

    def note(name):
        return lambda _: names.append(name)

    assert settled_by(one, tuple(evolve(attempt, run=note(attempt.name)) for attempt in order)) is None
    return names


def test_the_order_depends_on_the_matrix():
    skew = np.array([[1.0, 2.0, 0.0], [-2.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    q = [-1.0, 1.0, 0.0]
    expected = [ZERO, "active sets of A + shift I, from the last", "Lemke", "proof, early", "few groups of faces"]
    expected += ["Wang's path", "proof", "KKT path", "groups of faces", "all faces", "restarts"]
    assert tried(case(lcp.LCP(skew, q)), AUTOMATIC) == expected
    negative = lcp.LCP(-np.eye(3) + np.ones((3, 3)) * [[0.0], [-3.0], [1.0]], q)
    expected = [ZERO, "Lemke", "proof, early", "few groups of faces", "reflections", "KKT path, first", "proof"]
    expected += ["groups of faces", "all faces", "reflections, further", "restarts"]
    assert tried(case(negative), AUTOMATIC) == expected
    definite = lcp.LCP(np.full((3, 3), 1.0) + np.eye(3), q)
    assert tried(case(definite), AUTOMATIC)[:2] == ["active sets of A + shift I, from x = 0", ZERO]
    assert tried(case(lcp.LCP(skew, np.ones(3))), AUTOMATIC)[0] == "x = 0"
    assert tried(case(lcp.LCP(skew, q), x0=np.ones(3)), AUTOMATIC)[0] == "active sets, from x0"
    game = lcp.LCP([[0.0, 1.0], [2.0, 0.0]], [-1.0, -1.0])
    assert "Lemke and Howson" in tried(case(game), AUTOMATIC)
    membrane = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(300, 300), dtype=float)
    assert tried(case(lcp.LCP(membrane, -np.ones(300))), AUTOMATIC)[0] == "active sets, from coarser problems"


def test_a_sparse_matrix_is_dense_for_pivots_and_paths():
    r = np.random.default_rng(2)
    A = sp.random_array((20, 20), density=0.2, rng=r, data_sampler=r.standard_normal).tocsr()
    x, w = r.uniform(0.5, 2.0, (2, 20)) * (r.random(20) < [[0.5], [2.0]])
    problem = lcp.LCP(A, np.where(x > 0.0, 0.0, w) - A @ x)
    one = case(problem)
    settled_by(one, AUTOMATIC)
    assert not one.problem.sparse
    assert not one.search.finish.problem.sparse
    assert lcp.solve(problem, restarts=0).problem is problem
    large = sp.diags_array([1.0, -1.0], offsets=[0, 1], shape=(600, 600)).tocsr()
    assert "dense from here on" not in tried(case(lcp.LCP(large, -np.ones(600))), AUTOMATIC)


def test_a_path_that_is_wanted_comes_first():
    last = [*FACES, "reflections, further", "restarts"]
    assert tried(case(INFEASIBLE), PATHS) == ["Wang's path", "proof", "KKT path", *last]


def test_what_is_dear_is_left_out_when_the_budget_is_spent():
    one = case(lcp.LCP(np.eye(50), -np.ones(50)))
    one.search.counts.accepted = 10_000
    assert not {"proof", "KKT path"} & set(tried(one, AUTOMATIC))


def test_a_large_proof_is_looked_for_only_within_a_limit_of_seconds():
    q = -np.ones(1000)
    assert "proof" not in tried(case(lcp.LCP(np.eye(1000), q)), AUTOMATIC)
    assert "proof" in tried(case(lcp.LCP(sp.eye_array(1000, format="csc"), q)), AUTOMATIC)
    timed = case(lcp.LCP(np.eye(1000), q))
    timed.search.budget = continuation.Budget(seconds=60.0)
    assert "proof" in tried(timed, AUTOMATIC)


def test_all_faces_are_tried_where_they_are_few():
    assert "all faces" in tried(case(lcp.LCP(np.eye(12), -np.ones(12))), AUTOMATIC)
    assert "some groups of faces" in tried(case(lcp.LCP(np.eye(40), -np.ones(40))), AUTOMATIC)
    assert "few groups of faces" not in tried(case(lcp.LCP(np.eye(41), -np.ones(41))), AUTOMATIC)
    assert "groups of faces" in tried(case(lcp.LCP(np.eye(40), -np.ones(40))), AUTOMATIC)
    assert "groups of faces" not in tried(case(lcp.LCP(np.eye(41), -np.ones(41))), AUTOMATIC)
    assert "all faces" not in tried(case(lcp.LCP(np.eye(13), -np.ones(13))), AUTOMATIC)
    assert "all faces" not in tried(case(INFEASIBLE), NAMED)


def test_a_homotopy_by_name_looks_for_the_start_that_it_needs():
    assert tried(case(INFEASIBLE, asked="zhao"), NAMED) == ["feasible start", "path", "proof", "restarts"]
    assert tried(case(INFEASIBLE, asked="zhao", x0=np.ones(2)), NAMED)[0] == "path"
    assert tried(case(INFEASIBLE, asked="wang", restarts=0), NAMED) == ["path", "proof"]


def test_another_attempt_is_one_more_entry():
    guess = Attempt(
        "a guess", lambda c: True, lambda c: c.search.settle(np.zeros(2, dtype=np.int8), strategy.FIRST), "Guessed."
    )
    one = case(lcp.LCP(np.eye(2), [-1.0, -1.0]))
    settled = settled_by(one, (guess, *AUTOMATIC))
    assert settled is guess
    assert settled.said == "Guessed."
    np.testing.assert_array_equal(one.search.best().certificate.x, [1.0, 1.0])


@pytest.mark.parametrize(
    ("problem", "options", "expected"),
    [
        # The ray of Lemke's method has the proof already.
        (INFEASIBLE, {}, 0),
        (INFEASIBLE, {"path": True}, 1),
        (INFEASIBLE, {"homotopy": "kkt"}, 1),
        # Phase I has the proof already.
        (INFEASIBLE, {"homotopy": "zhao"}, 0),
        # Scaled: the proof is moved to the problem as given.
        (lcp.LCP([[0.0, 1e9], [-1e-9, 0.0]], [-1e9, -1.0]), {}, 0),
    ],
)
def test_a_proof_is_looked_for_once_and_holds_for_the_data_as_given(problem, options, expected, monkeypatch):
    calls = []
    monkeypatch.setattr(strategy, "infeasibility", lambda *a: calls.append(a) or infeasibility(*a))
    solution = lcp.solve(problem, **options)
    assert solution.outcome is lcp.Outcome.UNSOLVABLE
    y = np.array(solution.farkas.y, dtype=float)
    assert (problem.A.T @ y <= 0.0).all()
    assert problem.q @ y < 0.0
    assert len(calls) == expected


def test_a_start_whose_products_overflow_is_left_for_the_path_s_own():
    A = 1e300 * np.random.default_rng(0).standard_normal((5, 5))
    found = lcp.solve(lcp.LCP(A, -np.full(5, 1e-2)), x0=np.ones(5), path=True, restarts=0)
    assert found.paths[0].steps
