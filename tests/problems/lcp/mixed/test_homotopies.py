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
from problems.lcp.homotopies import elimination
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.mixed_strategies import mixed_lcps, planted_mixed_lcps
from problems.lcp.proof.verdict import stationary
from problems.lcp.reference.enumeration import exhaust
from problems.nonlinear import InteriorHomotopy, MixedComplementarity, solve_complementarity

from .util import orders, stationarity

BOUNDED = [name for name, one in HOMOTOPIES.items() if one.bounds]
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
    for start in (
        lcp.WangHomotopy(problem).start()[0], lcp.KKTHomotopy(problem).start()[0],
        lcp.random_start(problem, np.random.default_rng(0)).x0,
    ):  # fmt: skip
        assert np.isfinite(start).all()
        x = start[:7]
        assert ((x > problem.lower) & (x < problem.upper)).all()
    np.testing.assert_array_equal(lcp.WangHomotopy(problem).x0, [0.0, 5e-9, -6.0, 6.0, 1.0, 0.0, -6.75])


def test_a_fixed_unknown_has_no_inside():
    with pytest.raises(ValueError, match="problem: expected lower < upper, found a fixed unknown 1"):
        lcp.WangHomotopy(lcp.MixedLCP(np.eye(2), [1.0, 1.0], [0, 1], [1, 1]))


def drawn(rng, n, kinds=4):
    """A monotone problem with lower, upper, both and no bounds mixed."""
    M, kind = rng.standard_normal((n, n)), rng.integers(0, kinds, n)
    lower = np.where(kind % 2 == 0, rng.standard_normal(n), -INF)
    upper = np.where(kind == 1, rng.standard_normal(n), np.where(kind == 2, lower + 0.1 + rng.random(n), INF))
    return lcp.MixedLCP(M @ M.T / n + np.triu(M, 1) - np.triu(M, 1).T, rng.standard_normal(n), lower, upper)


def test_the_kkt_homotopy_has_three_five_or_two_unknowns_an_index():
    lower, upper = [0.0, -INF, -INF, 0.0], [INF, 1.0, INF, 1.0]
    for i, unknowns in enumerate((3, 3, 2, 5)):
        problem = lcp.MixedLCP([[1.0]], [-1.0], lower[i], upper[i])
        assert lcp.KKTHomotopy(problem).start()[0].size == unknowns
    assert lcp.KKTHomotopy(EVERY_KIND).start()[0].size == 13


@pytest.mark.parametrize("banded", [False, True])
def test_the_order_of_what_the_kkt_path_factors_is_n(monkeypatch, banded):
    found = orders(monkeypatch)
    for seed, n in ((1, 10), (2, 30)):
        problem = drawn(np.random.default_rng(seed), n)
        if banded:
            band = sp.diags_array([np.ones(n - 1), 3 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
            problem = lcp.MixedLCP(band, problem.q, problem.lower, problem.upper)
        found.clear()
        assert lcp.solve(problem, "kkt").success
        assert len(found) >= 10
        assert max(found) <= n


def test_without_the_finish_the_robust_core_of_order_2n_is_for_the_end_alone(monkeypatch):
    found, real = [], elimination.Core.of

    def spy(way, *arguments, **given):
        if getattr(way, "second", way) is None:
            found.append(way.system.lam)
        return real(way, *arguments, **given)

    monkeypatch.setattr(elimination.Core, "of", spy)
    for seed in range(8):
        assert lcp.solve(drawn(np.random.default_rng(seed), 12), "kkt", finish=False).success
    assert len(found) <= 20
    assert not any(found), "what is zero at lambda = 0 is small before"


def test_a_start_of_the_kkt_homotopy_for_every_kind_of_bound():
    rng = np.random.default_rng(0)
    given_ = {
        "x0": [1.0, 0.0, 0.0, 2.0],
        "z1": rng.random(4) + 0.1,
        "z2": [1.0, -2.0, 0.5, -9.0],
        "w0": [1.0, 2.0, 3.0, 4.0],
    }
    homotopy = lcp.KKTHomotopy(EVERY_KIND, **given_)
    y, lam = homotopy.start()
    # Of four bounds, the lower ones of 0 and 2, the upper ones of 1 and 2, the last is that of the box above: t0.
    np.testing.assert_array_equal(y, [*given_["x0"], *given_["z1"], *given_["z2"], 4.0])
    np.testing.assert_array_equal(homotopy.residual(y, lam), 0.0)
    for name, value, message in (
        ("x0", [1.0, 1.0, 0.0, 2.0], r"x0: expected a number between -inf and 1\.0 at index 1, found 1\.0"),
        ("z1", [1.0, 1.0], "z1: expected 4 positive numbers"),
        ("z2", [1.0, 2.0, 0.5, 0.0], r"z2: expected a number between -inf and 0\.0 at index 1, found 2\.0"),
        ("z2", [1.0, -2.0, 2.0, 0.0], r"z2: expected a number between 0\.0 and 2\.0 at index 2, found 2\.0"),
        ("w0", [1.0, 1.0, -1.0, 1.0], "w0: expected positive finite numbers"),
    ):
        with pytest.raises(ValueError, match=message):
            lcp.KKTHomotopy(EVERY_KIND, **{name: value})


def test_the_kkt_equations_of_a_box_by_hand():
    """A = 2, q = -3 on [1, 4], x0 = 2, z1 = (5, 6), z2 = 1, (s0, t0) = (7, 8); rho = 7 - 8 - 1."""
    homotopy = lcp.KKTHomotopy(lcp.MixedLCP([[2.0]], [-3.0], 1, 4), [2.0], [5.0, 6.0], [1.0], [7.0, 8.0])
    # At x = 3, z1 = (1, 2), z2 = 2, t = 5, lambda = 1/4: w = 3, and 3 - 1/2 + 5 is what is complementary to z2.
    expected = [
        0.75 * (3 + 2 * (2 - 2) - 1 + 2) + 0.25 * (3 - 2), 1 * 2 - 0.25 * 5 * 1, 2 * 1 - 0.25 * 6 * 2,
        2 * 7.5 - 0.25 * 1 * 7, (3 - 2) * 5 - 0.25 * 2 * 8,
    ]  # fmt: skip
    np.testing.assert_allclose(homotopy.residual(np.array([3.0, 1.0, 2.0, 2.0, 5.0]), 0.25), expected, rtol=1e-15)


def positives(homotopy, u):
    """Distances, forces, multipliers and what they are complementary to, in the order of the blocks."""
    rows = homotopy.rows
    x, z1, z2, t = homotopy.split(u[:-1])
    w = homotopy.problem.w(x) + u[-1] * homotopy.rho
    low, high = rows.bounds
    z = np.minimum(z2 - low, high - z2)
    return np.concatenate([rows.sides.gaps(x), z1, z[np.isfinite(z)], t, (rows.signs * rows.raised(w, t))[~rows.free]])


@pytest.mark.parametrize("seed", range(4))
def test_derivatives_series_and_longest_steps_of_the_kkt_homotopy(seed):
    """For all kinds of bounds; H is quadratic, so that central differences of any width are exact."""
    rng = np.random.default_rng(seed)
    homotopy = lcp.KKTHomotopy(drawn(rng, 5))
    y, lam = homotopy.start()
    u, v = np.append(y, lam), rng.standard_normal(y.size + 1)
    ahead, behind = (homotopy.residual(y + s * v[:-1], lam + s * v[-1]) for s in (1.0, -1.0))
    H_y, H_lam = homotopy.jacobian(y, lam)
    scale = np.abs(ahead).max() + np.abs(behind).max()
    np.testing.assert_allclose(H_y @ v[:-1] + H_lam * v[-1], (ahead - behind) / 2, atol=1e-13 * scale)
    np.testing.assert_allclose(homotopy.differential(y, lam, v), (ahead - behind) / 2, atol=1e-13 * scale)
    h = homotopy.max_step(u, v)
    assert 0.0 < h < np.inf
    assert (positives(homotopy, u + h * (1 - 1e-9) * v) > 0.0).all()
    assert not (positives(homotopy, u + h * (1 + 1e-9) * v) > 0.0).all()


@pytest.mark.parametrize("seed", range(3))
def test_an_end_of_the_kkt_path_is_stationary(seed):
    """Where A is not monotone the end may be no solution: it satisfies the conditions of order 2n all the same."""
    rng = np.random.default_rng(seed)
    homotopy = lcp.KKTHomotopy(lcp.MixedLCP(rng.standard_normal((6, 6)), rng.standard_normal(6), -1.0, 2.0))
    path = continuation.trace(homotopy)
    assert path.success
    assert stationary(homotopy.problem, path.endpoint.y)
    x, _, z, _ = homotopy.split(path.endpoint.y)
    both = stationarity(homotopy.problem)
    assert both.relative_residual(np.append(x, z)) <= 1e-8
    assert not stationary(homotopy.problem, path.endpoint.y + 0.1)


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
    d = np.where(np.isfinite(low), x - low, np.where(np.isfinite(high), x - high, x))
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
