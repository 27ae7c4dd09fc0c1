"""The augmented Lagrangian of a program: what it is made of, and programs on which active sets alone cycle."""

from itertools import islice

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import linprog, minimize_scalar

from continuation.counts import Counts
from problems import lcp
from problems.lcp import Outcome
from problems.lcp.active_set.augmented import Penalised, Saddle, guesses
from problems.lcp.active_set.face import exchanging
from problems.lcp.proof.verdict import to_precision

INF = np.inf


def program(rng, n=6, convex=True, sparse=False):
    """Rows of every kind around a point in the box."""
    P = rng.integers(-3, 4, (n, n)).astype(float)
    P = P @ P.T if convex else P + P.T
    G, B = rng.integers(-3, 4, (5, n)).astype(float), rng.integers(-3, 4, (1, n)).astype(float)
    x = rng.random(n)
    low, high = G @ x - [1.0, INF, 0.5, 0.0, 1.0], G @ x + [INF, 1.0, 0.5, 0.0, 2.0]
    if sparse:
        P, G = sp.csr_array(P), sp.csr_array(G)
    return lcp.from_qp(P, rng.integers(-4, 5, n).astype(float), G, high, B, B @ x, 0, 1, rows_lower=low)


@pytest.mark.parametrize("sparse", [False, True])
def test_a_program_is_read_from_its_conditions(sparse):
    made = program(np.random.default_rng(0), sparse=sparse)
    saddle = Saddle.of(made.problem)
    n = made.n
    dense = saddle.R.toarray() if sparse else saddle.R
    assert dense.shape == (6, n)  # one row has equal sides
    rng = np.random.default_rng(1)
    for x in rng.uniform(-1.0, 2.0, (20, n)):
        # w of the conditions at x, with each activity at the value of its row: what is asked of R x + d.
        whole = np.zeros(made.problem.n)
        whole[:n] = x
        values = saddle.R @ x + saddle.d
        two = saddle.activity >= 0
        whole[saddle.activity[two]] = values[two]
        inside = (saddle.low <= values) & (values <= saddle.high)
        w, problem = made.problem.w(whole), made.problem
        signed = problem.lower[saddle.multiplier] == 0.0
        free = ~signed & ~two
        np.testing.assert_array_equal(inside[signed], w[saddle.multiplier][signed] >= 0.0)
        np.testing.assert_array_equal(inside[free], w[saddle.multiplier][free] == 0.0)
        at = whole[saddle.activity[two]]
        ends = problem.lower[saddle.activity[two]], problem.upper[saddle.activity[two]]
        np.testing.assert_array_equal(inside[two], (ends[0] <= at) & (at <= ends[1]))


def test_what_is_no_program_is_not_read_as_one():
    A = np.array([[2.0, -1.0], [1.0, 0.0]])
    assert Saddle.of(lcp.MixedLCP(A, [0.0, 0.0], -INF, INF, primal=1)) is not None
    for wrong in ([[2.0, 1.0], [1.0, 0.0]], [[2.0, -1.0], [1.0, 0.5]]):
        assert Saddle.of(lcp.MixedLCP(wrong, [0.0, 0.0], -INF, INF, primal=1)) is None
    assert Saddle.of(lcp.MixedLCP(A, [0.0, 0.0], -INF, INF)) is None
    assert Saddle.of(lcp.MixedLCP(A, [0.0, 0.0], [-INF, 0], [INF, 1], primal=1)) is None
    assert Saddle.of(lcp.MixedLCP(A, [0.0, 0.0], [-INF, 1], [INF, INF], primal=1)) is None


def test_a_step_goes_to_the_minimum_on_its_line():
    rng = np.random.default_rng(2)
    saddle = Saddle.of(program(rng).problem)
    m, n = saddle.multiplier.size, saddle.c.size
    low, high = np.append(saddle.low, np.zeros(n)), np.append(saddle.high, np.ones(n))
    for _ in range(30):
        one = Penalised(saddle, low, high, 10.0 ** rng.uniform(-1, 2), 3.0)
        x, y, d = rng.standard_normal(n), rng.standard_normal(m + n), rng.standard_normal(n)

        def value(s, one=one, x=x, y=y, d=d):
            z = x + s * d
            t = one.values(z) + y / one.sigma
            away = t - np.clip(t, low, high)
            return 0.5 * z @ saddle.P @ z + saddle.c @ z + s * s * d @ d / 6.0 + 0.5 * one.sigma * away @ away

        slope = (value(1e-6) - value(-1e-6)) / 2e-6
        if slope > 0.0:
            continue
        t = one.values(x) + y / one.sigma
        along = one.values(d) - one.values(0.0 * d)
        found = one.step(t, along, slope, float(d @ saddle.P @ d + d @ d / 3.0))
        assert found == pytest.approx(minimize_scalar(value, tol=1e-12).x, rel=1e-5, abs=1e-7)


def test_the_multipliers_converge_to_those_of_the_program():
    made = program(np.random.default_rng(3))
    wanted = lcp.solve(made)
    counts = Counts()
    found = guesses(Saddle.of(made.problem), 0.0, np.zeros(made.n), counts, exchanging())
    _, point = next(islice(found, 15, None))
    np.testing.assert_allclose(point[: made.n], wanted.x[: made.n], atol=1e-8)
    assert counts.factorizations < 60


@pytest.mark.parametrize("sparse", [False, True])
def test_degenerate_linear_programs_need_no_path(sparse):
    """Transport with equal supplies and demands: every vertex is degenerate, and unshifted active sets cycle."""
    rng, k = np.random.default_rng(4), 7
    ones, eye = np.ones((1, k)), np.eye(k)
    rows = np.vstack([np.kron(eye, ones), np.kron(ones, eye)])
    for _ in range(5):
        cost = rng.integers(1, 20, k * k).astype(float)
        given = sp.csr_array(rows) if sparse else rows
        solution = lcp.solve(lcp.from_lp(cost, A_eq=given, b_eq=np.ones(2 * k), lower=0))
        assert solution.success, solution.message
        assert not solution.paths
        assert solution.objective == pytest.approx(linprog(cost, A_eq=rows, b_eq=np.ones(2 * k)).fun, abs=1e-12)


def test_a_program_that_is_not_convex_with_rows_gives_a_kkt_point():
    rng = np.random.default_rng(5)
    for _ in range(20):
        made = program(rng, n=8, convex=False)
        solution = lcp.solve(made)
        assert solution.success, solution.message
        assert solution.residual <= 1e-11


def test_rounding_in_place_of_a_zero_is_solved_to_precision_and_said():
    """A row that asks of variables without a sign change to sum to -1e-17: no x does, and for zeros all do."""
    rng, n = np.random.default_rng(6), 60
    M = rng.standard_normal((n, n))
    rows = np.vstack([np.append(np.ones(3), np.zeros(n - 3)), rng.standard_normal((10, n))])
    high = np.append(-1e-17, 5.0 + rng.random(10))
    G, lower = np.abs(rows), np.append(np.zeros(3), np.full(n - 3, -1.0))
    made = lcp.from_qp(M @ M.T / n, rng.standard_normal(n), G, high, lower=lower, upper=1.0)
    solution = lcp.solve(made)
    assert solution.outcome is Outcome.SOLVED_TO_PRECISION
    assert solution.residual <= 1e-14
    assert "rounding in place of a zero; so the data as given may have no solution" in solution.message
    high[0] = 0.0
    assert lcp.solve(lcp.from_qp(M @ M.T / n, made.c, G, high, lower=lower, upper=1.0)).outcome is Outcome.SOLVED
    high[0] = -1e-6
    solution = lcp.solve(lcp.from_qp(M @ M.T / n, made.c, G, high, lower=lower, upper=1.0))
    assert solution.outcome is Outcome.UNSOLVABLE


def test_a_point_far_along_a_ray_does_not_solve_to_precision():
    """The objective falls for ever along (1, 1): relative to x its slope is rounding, relative to q it is not."""
    problem = lcp.from_lp([-1.0, 0.0], A_eq=[[1.0, -1.0]], b_eq=[0.0], lower=0).problem
    far = np.array([1e17, 1e17, 0.0])
    assert problem.relative_residual(far) <= 1e-16
    assert not to_precision(problem, lcp.certify(problem, far))
    near = lcp.from_lp([1.0, 0.0], A_eq=[[1.0, -1.0]], b_eq=[0.0], lower=0).problem
    assert to_precision(near, lcp.certify(near, np.zeros(3)))
