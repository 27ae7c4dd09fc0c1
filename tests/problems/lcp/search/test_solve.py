"""`solve`: its outcomes are true, its answers exact, its parts switchable, its door firm."""

import numpy as np
import pytest
import scipy.sparse as sp

import continuation
from continuation.predictors import Taylor
from problems import lcp
from problems.lcp.data.matrix_facts import MatrixFacts
from problems.lcp.data.scaling import balanced
from problems.paper import COUNTEREXAMPLES, EXAMPLES

Outcome = lcp.Outcome
PD = lcp.LCP([[4.0, -1.0, 0.5], [1.0, 3.0, -1.0], [0.0, 1.0, 2.0]], [-1.0, 1.0, -2.0])


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda e: e.label)
@pytest.mark.parametrize("finish", [True, False])
def test_the_ten_examples_end_at_the_printed_solution(example, finish):
    solution = lcp.solve(example.problem, "kkt", x0=example.x0, finish=finish, preset=continuation.SERIES)
    assert solution.outcome is Outcome.SOLVED
    assert solution.relative_residual <= 1e-14
    np.testing.assert_allclose(solution.x, example.printed_solution, atol=1e-4)
    assert solution.path.status is continuation.Status.REACHED_TARGET
    assert len(solution.paths) == 1


def test_auto_solves_the_ten_examples_exactly():
    for example in EXAMPLES:
        solution = lcp.solve(example.problem, x0=example.x0)
        assert solution.outcome is Outcome.SOLVED
        assert solution.relative_residual <= 1e-14
        exact = [np.array([float(v) for v in s]) for s in example.solutions]
        assert min(np.abs(solution.x - s).max() for s in exact) <= 1e-12 * (1 + np.abs(solution.x).max())


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
    solution = lcp.solve(case.problem, "kkt", x0=case.x0)
    assert solution.outcome is Outcome.STATIONARY
    np.testing.assert_allclose(solution.x, case.end, atol=1e-4)
    assert "does not solve the LCP" in solution.message
    assert "No restarts" in solution.message
    tried = lcp.solve(case.problem, "kkt", x0=case.x0, restarts=4)
    assert tried.outcome is Outcome.STATIONARY
    assert "Restarts from random starts: 4" in tried.message
    assert len(tried.paths) == 5


def test_stationary_means_that_the_optimality_conditions_hold():
    case = COUNTEREXAMPLES[0]
    solution = lcp.solve(case.problem, "kkt", restarts=6)
    A, q, n = case.A, case.q, case.q.size
    x, z1, z2 = np.split(solution.path.endpoint.y, 3)
    w = A @ x + q
    np.testing.assert_allclose((A + A.T) @ x + q - z1 - A.T @ z2, np.zeros(n), atol=1e-5)
    assert max(np.abs(z1 * x).max(), np.abs(z2 * w).max()) <= 1e-5
    assert solution.residual > 0.1


def test_unsolvable_comes_with_a_proof_that_can_be_checked_by_hand():
    # w2 = -x1 - 1 < 0 for every x >= 0.
    problem = lcp.LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0])
    for solution in (lcp.solve(problem), lcp.solve(problem, "kkt"), lcp.solve(problem, "zhao")):
        assert solution.outcome is Outcome.UNSOLVABLE
        y = np.array(solution.farkas.y, dtype=float)
        assert (y >= 0).all()
        assert (problem.A.T @ y <= 0).all()
        assert problem.q @ y < 0


def test_a_feasible_problem_without_solution_is_called_unsolvable_only_where_all_faces_were_tried():
    problem = COUNTEREXAMPLES[1].problem
    solution = lcp.solve(problem, "kkt", restarts=3)
    assert solution.outcome in (Outcome.STATIONARY, Outcome.NOT_FOUND)
    assert solution.proof == ""
    decided = lcp.solve(problem)
    assert decided.outcome is Outcome.UNSOLVABLE
    assert decided.farkas is None
    assert decided.exhaustion.faces == 2**problem.n
    assert not decided.exhaustion.solvable
    assert "complementary faces" in decided.proof
    assert decided.proof in decided.message


def test_collapse_is_infeasible_to_working_precision():
    # Three bars under a load above their joint capacity: y = (1, 1, 1) has q'y = -0.1, and A'y = 0 but for rounding.
    problem = lcp.LCP(np.eye(3) - np.ones((3, 3)) / 3, np.array([0.3, 0.6, 1.2]) - 2.2 / 3)
    assert lcp.farkas(problem) is None
    solution = lcp.solve(problem)
    assert solution.outcome is Outcome.INFEASIBLE_TO_PRECISION
    assert not solution.paths
    np.testing.assert_allclose(solution.float_farkas.y, np.ones(3), rtol=1e-12)
    assert solution.float_farkas.error <= 1e-14
    assert solution.float_farkas.gap == pytest.approx(0.1 / np.abs(problem.q).sum())
    units = np.array([1e-6, 3.0, 1e5])
    moved = lcp.solve(lcp.LCP(units[:, None] * problem.A, units * problem.q))
    assert moved.outcome is Outcome.INFEASIBLE_TO_PRECISION
    y = moved.float_farkas.y * units
    np.testing.assert_allclose(y / y.max(), np.ones(3), rtol=1e-12)
    assert lcp.solve(lcp.LCP(problem.A, np.array([0.3, 0.6, 1.2]) - 2.05 / 3)).outcome is Outcome.SOLVED


@pytest.mark.parametrize("name", ["auto", "kkt", "wang", "yu", "xu", "kmm"])
def test_every_homotopy_by_name(name):
    solution = lcp.solve(PD, name)
    expected = np.array([0.25, 0.0, 1.0]) - [0.125, 0.0, 0.0]
    assert solution.outcome is Outcome.SOLVED
    np.testing.assert_allclose(solution.x, expected, atol=1e-13)
    assert solution.seconds > 0.0


def test_nonnegative_q_is_solved_by_zero_without_work():
    solution = lcp.solve(lcp.LCP(-np.ones((3, 3)), [0.0, 1.0, 2.0]))
    assert solution.outcome is Outcome.SOLVED
    assert (solution.x == 0.0).all()
    assert solution.counts.factorizations == 0
    assert not solution.paths
    # There is a path to draw all the same: one point.
    assert len(solution.path) == 1
    assert solution.path.endpoint.y.shape == (3,)


def test_without_finish_the_path_is_the_pure_homotopy():
    solution = lcp.solve(PD, finish=False)
    assert solution.outcome is Outcome.SOLVED
    homotopy = lcp.WangHomotopy(balanced(PD).problem)
    pure = continuation.trace(homotopy, preset=continuation.FAST)
    np.testing.assert_array_equal(solution.path.u, pure.u)


def test_the_outcome_is_judged_by_the_certificate_alone(monkeypatch):
    monkeypatch.setattr("problems.lcp.proof.certificate.Certificate.solves", lambda self, tolerance=0.0: False)
    solution = lcp.solve(PD, restarts=1)
    assert solution.outcome is not Outcome.SOLVED


def test_a_path_to_infinity_along_a_solution_of_the_homogeneous_problem_is_no_solution():
    # w1 = -1 always; x2 -> infinity makes the residual small relative to |x|, and to nothing else.
    problem = lcp.LCP([[0.0, 0.0], [0.0, 1.0]], [-1.0, -1e9])
    assert lcp.solve(problem, restarts=2).outcome is Outcome.UNSOLVABLE


def test_the_budget_ends_the_search():
    problem = COUNTEREXAMPLES[0].problem
    # The pure path alone: with the finish all faces of so small a problem are tried first.
    solution = lcp.solve(problem, budget=continuation.Budget(steps=5), restarts=50, finish=False)
    assert solution.outcome is Outcome.NOT_FOUND
    assert "budget" in solution.message.lower()
    assert len(solution.paths) == 1


def test_counts_add_up():
    solution = lcp.solve(COUNTEREXAMPLES[0].problem, restarts=3, path=True)
    assert solution.paths
    assert solution.counts.accepted == sum(path.counts.accepted for path in solution.paths)
    assert solution.counts.factorizations >= sum(path.counts.factorizations for path in solution.paths)


@pytest.mark.parametrize("symmetric", [True, False])
def test_scales_from_1e_minus_8_to_1e8(symmetric):
    rng = np.random.default_rng(4)
    n = 12
    M, S = rng.standard_normal((2, n, n))
    A = M @ M.T / n + 0.1 * np.eye(n) + (0.0 if symmetric else 1.0) * (S - S.T)
    x = np.maximum(rng.standard_normal(n), 0.0)
    w = np.where(x == 0.0, np.abs(rng.standard_normal(n)), 0.0)
    D = 10.0 ** rng.uniform(-4, 4, n)
    R = D if symmetric else 10.0 ** rng.uniform(-4, 4, n)
    whole = R[:, None] * A * D
    problem = lcp.LCP((whole + whole.T) / 2 if symmetric else whole, R * (w - A @ x))
    solution = lcp.solve(problem)
    assert solution.outcome is Outcome.SOLVED
    np.testing.assert_allclose(solution.x * D, x, rtol=1e-9, atol=1e-9)
    assert "scaled" in solution.message
    scaled = balanced(problem)
    entries = np.abs(scaled.problem.A).max(axis=1)
    assert entries.max() / entries.min() < 1e3
    if symmetric:
        np.testing.assert_array_equal(scaled.problem.A, scaled.problem.A.T)
    assert solution.problem is problem
    assert balanced(lcp.LCP(np.eye(3), [1.0, -1.0, 1.0])) is None


def test_scaled_paths_solve_what_needs_a_path():
    rng = np.random.default_rng(0)
    C, D = rng.uniform(0.1, 1.0, (2, 6, 6))
    A = np.block([[np.zeros((6, 6)), C], [D.T, np.zeros((6, 6))]])
    scale = 10.0 ** rng.uniform(-4, 4, 12)
    problem = lcp.LCP(scale[:, None] * A, -scale)
    assert lcp.solve(problem).outcome is Outcome.SOLVED


@pytest.mark.parametrize("seed", range(5))
def test_redundant_frictional_contacts(seed):
    # Two-dimensional Stewart-Trinkle: singular and copositive, and the solution not strictly complementary.
    problem = contact(3 + seed, seed)
    solution = lcp.solve(problem)
    assert solution.outcome is Outcome.SOLVED
    assert solution.relative_residual <= 1e-10


def contact(k, seed):
    rng = np.random.default_rng(seed)
    place = rng.uniform(-1.0, 1.0, (2, k))
    N = np.vstack([np.zeros(k), np.ones(k), place[0]])
    T = np.vstack([np.ones(k), np.zeros(k), -place[1]])
    B = np.hstack([N, np.stack([T, -T], axis=2).reshape(3, 2 * k)])
    E = np.kron(np.eye(k), np.ones((2, 1)))
    A = np.zeros((4 * k, 4 * k))
    A[: 3 * k, : 3 * k] = B.T @ B
    A[k : 3 * k, 3 * k :], A[3 * k :, :k] = E, np.diag(rng.uniform(0.2, 0.9, k))
    A[3 * k :, k : 3 * k] = -E.T
    return lcp.LCP(A, np.concatenate([B.T @ [rng.normal(), -1.0, rng.normal(0.0, 0.3)], np.zeros(k)]))


@pytest.mark.parametrize("family", ["murty", "fathi"])
def test_exponential_families_cost_the_same_at_every_size(family):
    work = []
    for n in (25, 50, 100):
        lower = np.eye(n) + np.tril(np.full((n, n), 2.0), -1)
        problem = lcp.LCP(lower.T if family == "murty" else lower @ lower.T, -np.ones(n))
        solution = lcp.solve(problem)
        assert solution.outcome is Outcome.SOLVED
        work.append(solution.counts.factorizations)
    assert max(work) <= 100


def test_a_large_sparse_problem_is_never_made_dense():
    n = 20_000
    A = sp.diags_array([-1.0, 2.2, -1.0], offsets=[-1, 0, 1], shape=(n, n), dtype=float)
    rng = np.random.default_rng(0)
    problem = lcp.LCP(A, rng.standard_normal(n))
    solution = lcp.solve(problem)
    assert solution.outcome is Outcome.SOLVED
    assert solution.relative_residual <= 1e-14


def test_the_look_proves_what_it_says():
    seen = MatrixFacts(lcp.Structure(lcp.LCP([[2.0, -1.0], [-1.0, 2.0]], [0.0, 0.0])))
    assert (seen.symmetric, seen.semidefinite, seen.z_matrix, seen.nonnegative, seen.negative_diagonal) == (
        True, True, True, False, False,
    )  # fmt: skip
    seen = MatrixFacts(lcp.Structure(lcp.LCP(sp.csr_array([[0.0, 1.0], [2.0, 0.0]]), [0.0, 0.0])))
    assert (seen.symmetric, seen.semidefinite, seen.z_matrix, seen.nonnegative) == (False, False, False, True)
    seen = MatrixFacts(lcp.Structure(lcp.LCP([[-1.0]], [1.0])))
    assert seen.negative_diagonal


def test_a_message_begins_with_what_the_outcome_means():
    sentences = {str(outcome) for outcome in Outcome}
    assert len(sentences) == len(Outcome)
    unsolvable = lcp.LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0])
    stopped = {"finish": False, "budget": continuation.Budget(steps=1)}
    for problem, options, outcome in (
        (PD, {}, Outcome.SOLVED),
        (COUNTEREXAMPLES[0].problem, {"homotopy": "kkt"}, Outcome.STATIONARY),
        (unsolvable, {}, Outcome.UNSOLVABLE),
        (PD, stopped, Outcome.NOT_FOUND),
    ):
        solution = lcp.solve(problem, **options)
        assert solution.outcome is outcome
        assert solution.message.startswith(f"{outcome} ")


def test_a_path_is_traced_where_one_is_asked_for():
    for problem in (PD, lcp.LCP(np.eye(2), [1.0, 2.0]), lcp.LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0])):
        plain, wanted = lcp.solve(problem), lcp.solve(problem, path=True)
        assert not plain.paths
        assert wanted.paths
        assert wanted.outcome is plain.outcome
        assert len(wanted.path) > 1


SMOKE = 500


def test_no_false_claim_on_random_small_problems():
    """Every claim against enumeration in exact arithmetic; `examples/benchmarks/claims.py truth` runs many more."""
    rng = np.random.default_rng(20)
    seen = dict.fromkeys(Outcome, 0)
    for k in range(SMOKE):
        n = int(rng.integers(1, 6))
        density = rng.choice([0.4, 1.0])
        A = rng.integers(-3, 4, (n, n)) * (rng.random((n, n)) < density)
        problem = lcp.LCP(A, rng.integers(-3, 4, n))
        solution = lcp.solve(problem, restarts=int(k % 10 == 0))
        seen[solution.outcome] += 1
        if solution.outcome in (Outcome.SOLVED, Outcome.UNSOLVABLE):
            truth = lcp.solve_by_enumeration(problem)
            assert truth.solvable is (solution.outcome is Outcome.SOLVED), (A, problem.q)
    assert seen[Outcome.SOLVED] > 0.4 * SMOKE
    assert seen[Outcome.UNSOLVABLE] > 0.05 * SMOKE
