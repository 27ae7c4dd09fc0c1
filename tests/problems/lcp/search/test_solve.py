"""`solve`: its outcomes are true, its answers exact, its parts switchable, its door firm."""

from collections import Counter

import numpy as np
import pytest
import scipy.sparse as sp

import continuation
from continuation.predictors import Taylor
from problems import lcp
from problems.lcp.data.scaling import balanced
from problems.paper import COUNTEREXAMPLES, EXAMPLES

from ..util import solution_of

Outcome = lcp.Outcome
PD = lcp.LCP([[4.0, -1.0, 0.5], [1.0, 3.0, -1.0], [0.0, 1.0, 2.0]], [-1.0, 1.0, -2.0])


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda e: e.label)
@pytest.mark.parametrize("name", ["kkt", "auto"])
@pytest.mark.parametrize("finish", [True, False])
def test_the_ten_examples_are_solved(example, name, finish):
    solution = solution_of(example.problem, name, x0=example.x0, finish=finish, preset=continuation.SERIES)
    assert solution.relative_residual <= 1e-14
    off = min(np.abs(solution.x - np.array(x, float)).max() for x in example.solutions)
    assert off <= 1e-12 * (1 + solution.x.max())
    if name == "kkt":
        np.testing.assert_allclose(solution.x, example.printed_solution, atol=1e-4)
        assert [path.status for path in solution.paths] == [continuation.Status.REACHED_TARGET]


def test_the_series_follows_the_paths_of_the_examples_with_few_factorisations():
    parts = {"preset": continuation.SERIES, "predictor": Taylor(order=36, accuracy=1e-5, rational=True)}
    answers = [lcp.solve(example.problem, "kkt", x0=example.x0, **parts) for example in EXAMPLES]
    for example, solution in zip(EXAMPLES, answers):
        np.testing.assert_allclose(solution.x, example.printed_solution, atol=1e-4)
        assert solution.relative_residual <= 1e-14
    assert sum(solution.counts.factorizations for solution in answers[:9]) <= 60
    assert answers[9].counts.factorizations <= 60


@pytest.mark.parametrize("case", COUNTEREXAMPLES, ids=lambda c: c.matrix_class)
def test_the_counterexamples_end_stationary_and_say_so(case):
    for restarts, said in ((0, "No restarts"), (4, "Restarts from random starts: 4")):
        solution = solution_of(case.problem, "kkt", x0=case.x0, restarts=restarts, outcome=Outcome.STATIONARY)
        assert solution.message.startswith(f"{Outcome.STATIONARY} ")
        assert said in solution.message
        assert (len(solution.paths), solution.proof) == (1 + restarts, "")
    np.testing.assert_allclose(lcp.solve(case.problem, "kkt", x0=case.x0).x, case.end, atol=1e-4)


@pytest.mark.parametrize("case", COUNTEREXAMPLES, ids=lambda c: c.matrix_class)
def test_a_feasible_problem_without_solution_is_called_unsolvable_where_all_faces_were_tried(case):
    decided = solution_of(case.problem, outcome=Outcome.UNSOLVABLE)
    assert decided.farkas is None
    assert decided.exhaustion.faces == 2**case.problem.n
    assert decided.message.startswith(f"{Outcome.UNSOLVABLE} {decided.proof}")
    assert "complementary faces" in decided.proof


def test_collapse_is_infeasible_to_working_precision():
    # Three bars under a load above their joint capacity: y = (1, 1, 1) has q'y = -0.1, and A'y = 0 but for rounding.
    problem = lcp.LCP(np.eye(3) - np.ones((3, 3)) / 3, np.array([0.3, 0.6, 1.2]) - 2.2 / 3)
    assert lcp.farkas(problem) is None
    for units in (np.ones(3), np.array([1e-6, 3.0, 1e5])):
        solution = solution_of(
            lcp.LCP(units[:, None] * problem.A, units * problem.q), outcome=Outcome.INFEASIBLE_TO_PRECISION
        )
        assert not solution.paths
        y = solution.float_farkas.y * units
        np.testing.assert_allclose(y / y.max(), np.ones(3), rtol=1e-12)
        assert solution.float_farkas.y.max() == 1.0
        assert solution.float_farkas.error <= 1e-14
        assert solution.float_farkas.gap == pytest.approx(0.1 / np.abs(problem.q).sum())
    assert lcp.solve(lcp.LCP(problem.A, np.array([0.3, 0.6, 1.2]) - 2.05 / 3)).outcome is Outcome.SOLVED


def test_nonnegative_q_is_solved_by_zero_without_work():
    solution = solution_of(lcp.LCP(-np.ones((3, 3)), [0.0, 1.0, 2.0]))
    assert (solution.x == 0.0).all()
    assert (solution.counts.factorizations, solution.paths) == (0, ())
    # There is a path to draw all the same: one point.
    assert solution.path.y.shape == (1, 3)
    assert solution.path.steps[0].index == 0


def test_without_finish_the_path_is_the_pure_homotopy():
    solution = solution_of(PD, finish=False)
    homotopy = lcp.WangHomotopy(balanced(PD).problem)
    pure = continuation.trace(homotopy, preset=continuation.FAST)
    np.testing.assert_array_equal(solution.path.u, pure.u)


def test_the_outcome_is_judged_by_the_certificate_alone(monkeypatch):
    monkeypatch.setattr("problems.lcp.proof.certificate.Certificate.solves", lambda self, tolerance=0.0: False)
    solution = lcp.solve(PD, restarts=1)
    assert solution.outcome is not Outcome.SOLVED
    assert "By Lemke" not in solution.message


def test_the_budget_ends_the_search():
    problem = COUNTEREXAMPLES[0].problem
    # The pure path alone: with the finish all faces of so small a problem are tried first.
    solution = solution_of(
        problem, budget=continuation.Budget(steps=5), restarts=50, finish=False, outcome=Outcome.NOT_FOUND
    )
    assert "budget" in solution.message.lower()
    assert len(solution.paths) == 1
    # Lemke's method solves it, after the first active sets.
    solution = lcp.solve(
        lcp.LCP(np.kron(np.eye(2), [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 0.5, 2.0]]), -np.ones(6)),
        budget=continuation.Budget(factorizations=1),
    )
    assert (solution.outcome, solution.counts.factorizations) == (Outcome.NOT_FOUND, 1)


@pytest.mark.parametrize("family", ["murty", "fathi"])
def test_exponential_families_cost_the_same_at_every_size(family):
    work = []
    for n in (25, 50, 100):
        lower = np.eye(n) + np.tril(np.full((n, n), 2.0), -1)
        problem = lcp.LCP(lower.T if family == "murty" else lower @ lower.T, -np.ones(n))
        solution = solution_of(problem)
        work.append(solution.counts.factorizations)
    assert max(work) <= 100


def test_a_large_sparse_problem_is_never_made_dense():
    n = 20_000
    A = sp.diags_array([-1.0, 2.2, -1.0], offsets=[-1, 0, 1], shape=(n, n), dtype=float)
    solution = solution_of(lcp.LCP(A, np.random.default_rng(0).standard_normal(n)))
    assert solution.relative_residual <= 1e-14


def test_an_obstacle_that_is_touched_by_zeros_alone_needs_no_path():
    """Of an M-matrix with q = 0 on half of a line; the first step of an American put is such a problem."""
    n = 199
    A = sp.diags_array([-0.42, 1.84, -0.41], offsets=[-1, 0, 1], shape=(n, n), format="csr")
    found = solution_of(lcp.LCP(A, np.where(np.arange(n) < n // 2, 1e-3, 0.0) - 0.5 * (np.arange(n) == n // 2)))
    assert not found.paths


def test_a_path_is_traced_where_one_is_asked_for():
    for problem in (PD, lcp.LCP(np.eye(2), [1.0, 2.0]), lcp.LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0])):
        plain, wanted = lcp.solve(problem), lcp.solve(problem, path=True)
        assert not plain.paths
        assert wanted.paths
        assert wanted.outcome is plain.outcome
        assert len(wanted.path) > 1


def test_no_false_claim_on_random_small_problems():
    """Every claim against enumeration in exact arithmetic; `examples/benchmarks/claims.py truth` runs many more."""
    rng = np.random.default_rng(20)
    seen = Counter()
    for k in range(500):
        n = int(rng.integers(1, 6))
        A = rng.integers(-3, 4, (n, n)) * (rng.random((n, n)) < rng.choice([0.4, 1.0]))
        problem = lcp.LCP(A, rng.integers(-3, 4, n))
        solution = lcp.solve(problem, restarts=int(k % 10 == 0))
        seen[solution.outcome] += 1
        if solution.outcome in (Outcome.SOLVED, Outcome.UNSOLVABLE):
            truth = lcp.solve_by_enumeration(problem)
            assert truth.solvable is solution.solved, (A, problem.q)
    assert seen[Outcome.SOLVED] > 200
    assert seen[Outcome.UNSOLVABLE] > 25
