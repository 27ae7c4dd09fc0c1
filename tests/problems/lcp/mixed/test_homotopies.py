"""The homotopies with bounds: the checks of every plug-in, their starts, and what row sufficiency is good for."""

from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import continuation
from continuation.testing import check_homotopy
from problems import lcp
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.homotopies.stationarity import stationarity, stationary_homotopy
from problems.lcp.mixed_strategies import mixed_lcps, planted_mixed_lcps
from problems.lcp.reference.enumeration import exhaust
from problems.nonlinear import InteriorHomotopy, MixedComplementarity, solve_complementarity

BOUNDED = [name for name, one in HOMOTOPIES.items() if one.bounds and name != "kkt"]
INF = np.inf
MONOTONE = np.array([[2.0, 1.0, 0.0, 0.0], [-1.0, 1.0, 0.5, 0.0], [0.0, -0.5, 3.0, 1.0], [0.0, 0.0, -1.0, 0.0]])
EVERY_KIND = lcp.MixedLCP(MONOTONE, [-1.0, 2.0, -6.0, 0.5], [0.0, -INF, -1.0, -INF], [INF, 1.0, 1.0, INF])


@pytest.mark.parametrize("name", BOUNDED)
@pytest.mark.parametrize("sparse", [False, True])
def test_every_check_of_a_plug_in_passes(name, sparse):
    problem = EVERY_KIND
    if sparse:
        problem = lcp.MixedLCP(sp.csr_array(problem.A), problem.q, problem.lower, problem.upper)
    check_homotopy(HOMOTOPIES[name].from_x0(problem, None, lcp.Structure(problem)))


@pytest.mark.parametrize("name", BOUNDED)
def test_the_robust_core_agrees_with_the_full_system(name):
    """Forces far larger and far smaller than distances, in a box so narrow that both are larger."""
    problem = lcp.MixedLCP(MONOTONE, [-1.0, 2.0, -6.0, 0.5], [0.0, -INF, -1e-3, 0.0], [INF, 1.0, 1e-3, 1e-3])
    homotopy = HOMOTOPIES[name].make(problem, None)
    rng = np.random.default_rng(0)
    y, _ = homotopy.start()
    for _ in range(10):
        point = y.copy()
        point[4:] *= np.exp(4.0 * rng.standard_normal(y.size - 4))
        border = rng.standard_normal(y.size + 1)
        H_y, H_lam = homotopy.jacobian(point, 0.3)
        whole = np.vstack([np.column_stack([H_y, H_lam]), border])
        system = homotopy.bordered(point, 0.3, border)
        r = rng.standard_normal(y.size)
        wanted = np.linalg.solve(whole, np.append(r, 0.5))
        np.testing.assert_allclose(system.solve(r, 0.5), wanted, rtol=1e-7, atol=1e-9 * np.abs(wanted).max())
        assert system.sign == np.sign(np.linalg.det(whole))


def test_starts_are_inside_and_finite_for_any_bounds():
    lower = [-1e308, 0.0, -INF, 5.0, 0.0, -INF, -7.0]
    upper = [1e308, 1e-8, -5.0, INF, INF, INF, -6.5]
    problem = lcp.MixedLCP(np.eye(7), np.ones(7), lower, upper)
    for start in (lcp.WangHomotopy(problem).start()[0], lcp.random_start(problem, np.random.default_rng(0)).x0):
        x = start[:7]
        assert ((x > problem.lower) & (x < problem.upper)).all()
    np.testing.assert_array_equal(lcp.WangHomotopy(problem).x0, [0.0, 5e-9, -6.0, 6.0, 1.0, 0.0, -6.75])


def test_a_fixed_unknown_has_no_inside():
    with pytest.raises(ValueError, match="problem: expected lower < upper, found a fixed unknown 1"):
        lcp.WangHomotopy(lcp.MixedLCP(np.eye(2), [1.0, 1.0], [0, 1], [1, 1]))


def test_the_checks_of_a_plug_in_pass_for_the_path_to_a_stationary_point():
    check_homotopy(stationary_homotopy(EVERY_KIND))


@settings(max_examples=60)
@given(mixed_lcps("row_sufficient", n=st.integers(1, 3), kinds=("lower", "upper", "box", "free")))
def test_row_sufficiency_makes_stationary_points_solutions(problem):
    """Theorem in docs/bounds.md: every solution (x, z) of the optimality conditions, exactly, gives a solution x."""
    both = stationarity(problem)
    found = exhaust(both)
    if found.solvable:
        x, n = found.x, problem.n
        rows = [[Fraction(v) for v in row] for row in problem.A.tolist()]
        w = [sum(a * v for a, v in zip(row, x[:n])) + Fraction(c) for row, c in zip(rows, problem.q.tolist())]
        for x_i, w_i, low, high in zip(x, w, problem.lower, problem.upper):
            assert w_i <= 0 or x_i == low
            assert w_i >= 0 or x_i == high
    else:
        assert not exhaust(problem).solvable


@settings(max_examples=40)
@given(planted_mixed_lcps("any", n=st.integers(1, 3), kinds=("lower", "upper", "box", "free")))
def test_a_solution_is_a_stationary_point(planted):
    problem, x = planted
    low, high = problem.lower, problem.upper
    d = np.where(np.isfinite(low), x - low, np.where(np.isfinite(high), x - high, 0.0))
    assert stationarity(problem).natural_residual(np.concatenate([x, d])) == 0.0


def test_without_row_sufficiency_a_stationary_point_need_not_solve():
    """A = -1 on [0, 1] with q = -1: x = 0, z = 1 is stationary, and w = -1 there; x = 1 solves."""
    problem = lcp.MixedLCP([[-1.0]], [-1.0], 0.0, 2.0)
    both = stationarity(problem)
    found = [p for p in ([0.0, 0.0], [0.0, 2.0], [2.0, 2.0]) if both.natural_residual(np.array(p)) == 0.0]
    solutions = [p for p in found if problem.natural_residual(np.array(p[:1])) == 0.0]
    assert found != solutions
    assert solutions


def kojima_shindo(x):
    a, b, c, d = x
    return np.stack([
        3 * a * a + 2 * a * b + 2 * b * b + c + 3 * d - 6, 2 * a * a + a + b * b + 10 * c + 2 * d - 2,
        3 * a * a + a * b + 2 * b * b + 2 * c + 9 * d - 9, a * a + 3 * b * b + 2 * c + 3 * d - 3,
    ])  # fmt: skip


def test_both_solutions_of_kojima_and_shindo():
    problem = MixedComplementarity(kojima_shindo, lower=np.zeros(4))
    rng = np.random.default_rng(0)
    found = set()
    for _ in range(12):
        solution = solve_complementarity(problem, 3.0 * rng.random(4) + 0.01)
        assert solution.success
        found.add(tuple(np.round(solution.x, 12)))
    assert found == {(1.0, 0.0, 3.0, 0.0), (round(np.sqrt(1.5), 12), 0.0, 0.0, 0.5)}


def exponential(x):
    return np.exp(x) - np.array([2.0, 0.5, 3.0, 1.5, 9.0])


def exponential_slope(x):
    return np.diag(np.exp(x))


BOUNDS = {"lower": [0, 0, -INF, -5, 0], "upper": [1, 9, INF, INF, 1]}


@pytest.mark.parametrize("jacobian", [None, exponential_slope, lambda x: sp.csr_array(exponential_slope(x))])
def test_a_nonlinear_problem_with_bounds(jacobian):
    problem = MixedComplementarity(exponential, jacobian, **BOUNDS)
    wanted = [np.log(2.0), 0.0, np.log(3.0), np.log(1.5), 1.0]
    solution = solve_complementarity(problem)
    np.testing.assert_allclose(solution.x, wanted, atol=1e-15)
    assert solution.relative_residual <= 1e-15
    path = continuation.trace(InteriorHomotopy(problem))
    assert path.success
    np.testing.assert_allclose(path.endpoint.y[:5], wanted, atol=1e-8)


def test_every_check_of_a_plug_in_passes_for_nonlinear_problems():
    check_homotopy(InteriorHomotopy(MixedComplementarity(exponential, **BOUNDS)))
    check_homotopy(InteriorHomotopy(MixedComplementarity(kojima_shindo, lower=np.zeros(4))))


def test_a_path_is_followed_where_newtons_method_fails():
    """Powell's kind of failure: from the start the linearised problems have no solution."""
    problem = MixedComplementarity(lambda x: np.arctan(4.0 * (x - 3.0)), lower=[-INF], upper=[INF])
    solution = solve_complementarity(problem, [40.0])
    assert solution.success
    np.testing.assert_allclose(solution.x, [3.0], atol=1e-12)


NONLINEAR_REFUSED = {
    "no vector": ({}, "lower: expected a vector of bounds"),
    "fixed": ({"lower": [0, 1], "upper": [2, 1]}, "lower: expected less than upper, found both 1.0 at index 1"),
    "crossed": ({"lower": [0, 1], "upper": [2, 0]}, r"lower: expected at most upper, found lower\[1\]"),
    "shape": ({"lower": np.zeros(3)}, r"F\(a\): expected shape \(3,\), that of a, found \(2,\)"),
}


@pytest.mark.parametrize("case", NONLINEAR_REFUSED)
def test_bad_nonlinear_problems_are_refused(case):
    bounds, message = NONLINEAR_REFUSED[case]
    with pytest.raises(ValueError, match=message):
        MixedComplementarity(lambda x: x[:2], **bounds)
