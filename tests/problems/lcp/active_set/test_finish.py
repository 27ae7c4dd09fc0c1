"""Faces, the iteration over them, the finish from a guess and along a path, the guess from coarser problems."""

import itertools

import numpy as np
import pytest
import scipy.sparse as sp

import continuation
from continuation.archive import resume
from continuation.counts import Counts
from problems.lcp import LCP, KKTHomotopy, Structure, WangHomotopy, certify
from problems.lcp.active_set.face import Faces, exchanging
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.iteration import Ended, Policy, iterate, key_of
from problems.lcp.active_set.multigrid_guess import guess, suitable
from problems.lcp.active_set.on_path import AlongPath
from problems.lcp.data.problem import BETWEEN, LOWER
from problems.paper import EXAMPLES

from ..util import on_face


def faces(A, q):
    return Faces(Structure(LCP(A, q)))


def state_of(active):
    """The state of an LCP from where w = 0 is asked for."""
    return np.where(active, BETWEEN, LOWER)


@pytest.mark.parametrize(("make", "band"), [(np.asarray, 8), (sp.csr_array, 8), (sp.csr_array, 0)])
def test_a_face_is_solved_alike_in_every_storage(make, band, monkeypatch):
    if not band:
        monkeypatch.setattr("problems.lcp.data.matrix_structure.WIDEST_BAND", 0)
    n, rng = 30, np.random.default_rng(3)
    A = np.diag(4.0 + rng.random(n)) + np.diag(rng.standard_normal(n - 1), 1) + np.diag(rng.standard_normal(n - 1), -1)
    q, active = rng.standard_normal(n), rng.random(n) < 0.5
    x, w = faces(make(A), q).face(state_of(active)).point(np.zeros(n))
    expected = on_face(LCP(A, q), active)
    np.testing.assert_allclose(x, expected, atol=1e-14)
    np.testing.assert_allclose(w, np.where(active, 0.0, A @ expected + q), atol=1e-13)


@pytest.mark.parametrize("second", [1.0, 2.0])
def test_a_singular_face_gives_its_point_nearest_to_the_given_one(second):
    # Both rows say x1 + x2 = 1 (the second twice, where A is not symmetric).
    A = np.array([[1.0, 1.0], [second, second]])
    face = faces(A, -A @ [0.5, 0.5]).face(state_of(np.array([True, True])))
    assert not face.exact
    x, w = face.point(np.array([0.9, 0.3]))
    np.testing.assert_allclose(w, 0.0, atol=1e-12)
    assert (x > 0.0).all()
    assert second == 2.0 or x == pytest.approx([0.8, 0.2], abs=1e-6)


def test_no_active_set_is_tried_twice():
    finish = Finish(faces([[0.0, 1.0], [0.0, 0.0]], [-1.0, 1.0]), 1e-10)
    for active in (*itertools.product([False, True], repeat=2), [True, True]):
        assert finish.settle(state_of(np.array(active)), Policy(10)) is None
    assert finish.counts.factorizations <= 4


def test_a_singular_face_is_tried_again_from_elsewhere():
    # Solutions are x1 + x2 = 1 with x1 <= 1 / 4: the point nearest to zero is none, that nearest to (0, 1) is one.
    A, q = [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [-4.0, 0.0, 0.0]], [-1.0, -1.0, 1.0]
    finish, state = Finish(faces(A, q), 1e-10), state_of(np.array([True, True, False]))
    assert [finish.settle(state, Policy(0)) for _ in range(2)] == [None, None]
    assert finish.counts.factorizations == 1
    assert finish.settle(state, Policy(0), np.array([0.0, 1.0, 0.0])) is not None


def test_a_face_whose_signs_depend_on_round_off_is_corrected():
    # |A| is 4e10 here, so the elimination alone cannot tell x[j] = 3e-9 from a negative number.
    n = 20_000
    t = np.arange(1, n + 1) / (n + 1)
    A = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n), dtype=float) * (n + 1.0) ** 2
    problem = LCP(A, A @ np.maximum(0.15 - 16 * (t - 0.35) ** 2, 0.1 - 16 * (t - 0.7) ** 2) + 0.5)
    finish = Finish(Faces(Structure(problem)), 1e-12)
    x = finish.settle(guess(problem, exchanging(), Counts()), Policy(10))
    assert certify(problem, x).solves(1e-12)
    assert finish.counts.factorizations <= 6


@pytest.mark.parametrize(
    "A",
    [
        np.eye(3),
        sp.eye_array(500) * -1.0,
        sp.diags_array([1.0, 2.0, 1.0], offsets=[-1, 0, 1], shape=(500, 500), dtype=float),
    ],
    ids=["small", "negative", "of positive entries"],
)
def test_the_cascade_refuses_matrices_of_another_kind(A):
    assert not suitable(Structure(LCP(A, -np.ones(A.shape[0]))))


@pytest.mark.parametrize("make", [KKTHomotopy, WangHomotopy])
def test_a_path_with_the_finish_ends_exactly_and_sooner(make):
    homotopy = make(EXAMPLES[3].problem, EXAMPLES[3].x0)
    finish = Finish(Faces(homotopy.structure), 1e-14)
    path, pure = continuation.trace(homotopy, finish=AlongPath(finish, homotopy)), continuation.trace(homotopy)
    assert path.status is continuation.Status.REACHED_TARGET
    assert "finish" in path.message
    assert EXAMPLES[3].problem.natural_residual(path.endpoint.y[:3]) <= 1e-14
    assert path.counts.factorizations + finish.counts.factorizations < pure.counts.factorizations
    # Up to the finish it is the same path.
    np.testing.assert_array_equal(path.u[:-1], pure.u[: len(path) - 1])


def test_an_archive_holds_nothing_of_what_the_finish_tried(tmp_path):
    homotopy = KKTHomotopy(EXAMPLES[3].problem, EXAMPLES[3].x0)
    along = AlongPath(Finish(Faces(homotopy.structure), 1e-14), homotopy)
    continuation.trace(homotopy, finish=along, archive=tmp_path / "run.h5", budget=continuation.Budget(steps=3))
    again = resume(tmp_path / "run.h5", budget=continuation.Budget())
    np.testing.assert_array_equal(again.u, continuation.trace(homotopy).u)


ONE, SKEW, NONE = np.eye(2), [[0.0, 1.0], [0.0, 0.0]], [False, False]


@pytest.mark.parametrize(
    ("A", "active", "policy", "options", "ended"),
    [
        (ONE, [True, False], Policy(0), {}, Ended.SETTLED),
        (ONE, NONE, Policy(0), {}, Ended.STEPS),
        ([[0.0]], [True], Policy(5), {}, Ended.SINGULAR),
        (SKEW, NONE, Policy(5), {"tried": {key_of(state_of(NONE))}}, Ended.TRIED),
        # x1 enters, leaves and enters again: one change each.
        ([[-1.0]], [False], Policy(50, patience=3), {}, Ended.CYCLING),
        (SKEW, NONE, Policy(0), {"judge": lambda face, x, w: (x + 7.0, w, True)}, Ended.SOLVED),
    ],
)
def test_the_iteration_says_why_it_ended(A, active, policy, options, ended):
    found = iterate(faces(A, [-1.0, 1.0][: len(active)]), state_of(active), policy, **options)
    assert found.ended is ended
    assert ended is not Ended.SOLVED or (found.x == 7.0).all()
