"""`solve_many`: the answers of `solve`, of many problems at once; nothing is accepted that `solve` would not accept."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from problems import lcp
from problems.lcp import LCP, Outcome
from problems.lcp.proof.certificate import ROUND_OFF
from problems.lcp.search import many

from ....util import benchmark

campaign = benchmark("many.py")
KINDS = campaign.KINDS


@pytest.fixture
def one_by_one(monkeypatch):
    """The orders of the problems that `solve` is asked for, one by one."""
    asked = []

    def counted(problem, **options):
        asked.append(problem.n)
        return lcp.solve(problem, **options)

    monkeypatch.setattr(many, "solve", counted)
    return asked


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("n", [1, 2, 3, 5, 9])
def test_the_answers_are_those_of_solve(name, n):
    A, q = KINDS[name](6, n, np.random.default_rng([n, 7]))
    found = lcp.solve_many(A, q)
    for i, problem in enumerate(map(LCP, A, q)):
        one = lcp.solve(problem)
        assert (found.outcome[i], found.solved[i]) == (one.outcome, one.solved)
        if one.solved:
            certificate = lcp.certify(problem, found.x[i])
            assert certificate.solves()
            assert found.residual[i] == pytest.approx(certificate.residual, rel=1e-6, abs=1e-300)
            assert found.relative_residual[i] == pytest.approx(certificate.relative_residual, rel=1e-6, abs=1e-300)
        else:
            assert np.isnan(found.x[i]).all()


@pytest.mark.parametrize(("n", "k"), [(5, 200), (10, 200), (20, 200), (25, 2)])
def test_problems_with_p_matrices_are_solved_together_up_to_order_20(one_by_one, n, k):
    found = lcp.solve_many(*KINDS["p_matrices"](k, n, np.random.default_rng(n)))
    # The arguments are checked by one problem of order 1.
    assert one_by_one == ([1] if n <= 20 else [1, n, n])
    assert found.singly.tolist() == ([] if n <= 20 else [0, 1])
    assert len(found) == found.solved.sum() == k
    assert found.relative_residual.max() <= ROUND_OFF
    assert repr(found) == f"<Answers: {k} of {k} solved, n = {n}, {found.singly.size} one by one>"


def test_one_matrix_and_many_q():
    A, q = KINDS["p_matrices"](50, 4, np.random.default_rng(3))
    whole, stack = lcp.solve_many(A[0], q), lcp.solve_many(np.repeat(A[:1], 50, axis=0), q)
    np.testing.assert_array_equal(whole.x, stack.x)
    np.testing.assert_array_equal(whole.outcome, stack.outcome)


def test_an_executor_and_other_parts_change_nothing(monkeypatch):
    A, q = KINDS["indefinite"](30, 9, np.random.default_rng(4))
    alone = lcp.solve_many(A, q)
    monkeypatch.setattr(many, "ENTRIES", 300)
    with ThreadPoolExecutor(2) as executor:
        spread = lcp.solve_many(A, q, executor=executor)
    for name in ("x", "outcome", "residual", "relative_residual", "singly"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(spread, name))


def test_what_the_last_digit_decides_is_left_to_solve():
    """Floats prove nothing of a face whose equations are inconsistent by one digit."""
    A = np.array([[[1.0, -1.0], [-1.0, 1.0]]] * 2)
    q = np.array([[-1.0, 1.0], [-1.0, 1.0 - np.finfo(float).eps]])
    found = lcp.solve_many(A, q)
    assert (found.outcome.tolist(), found.singly.tolist()) == ([Outcome.SOLVED, Outcome.SOLVED_TO_PRECISION], [0, 1])


def test_nothing_and_no_unknowns():
    assert len(lcp.solve_many(np.zeros((0, 3, 3)), np.zeros((0, 3)))) == 0
    none = lcp.solve_many(np.zeros((2, 0, 0)), np.zeros((2, 0)))
    assert none.solved.all()
    assert none.x.shape == (2, 0)


@pytest.mark.parametrize(
    ("A", "q", "message"),
    [
        (np.eye(2), [1.0, 2.0], r"q: expected an array of shape \(k, n\), found shape \(2,\)"),
        (np.eye(3), np.ones((4, 2)), r"A: expected an array of shape \(4, 2, 2\) or \(2, 2\), found shape"),
        (np.eye(2), [[1.0, np.nan]], "q: expected finite numbers, found nan"),
        ([[np.inf]], [[1.0]], "A: expected finite numbers, found inf"),
    ],
)
def test_bad_input_is_refused_by_name(A, q, message):
    with pytest.raises(ValueError, match=message):
        lcp.solve_many(A, q)


def test_what_the_benchmark_says():
    assert "100 certified" in campaign.together(5, 100)
    assert campaign.CAMPAIGN.run(8, 1) == 0


def test_no_more_is_claimed_than_the_tolerance_asks():
    A, q = KINDS["p_matrices"](50, 5, np.random.default_rng(4))
    found = lcp.solve_many(A, q, tolerance=1e-20)
    assert (found.relative_residual[found.outcome == Outcome.SOLVED] <= 1e-20).all()
