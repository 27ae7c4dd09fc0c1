"""The homotopies with bounds: the checks of every plug-in, their starts, and what row sufficiency is good for."""

import numpy as np
import pytest
import scipy.sparse as sp

import continuation
from problems import lcp
from problems.lcp.proof.verdict import stationary
from problems.nonlinear import InteriorHomotopy, MixedComplementarity, solve_complementarity

from ....util import path_of
from ...util import BOX, exponential, kojima_shindo
from ..homotopies.util import bordered_at
from .util import EVERY_KIND, stationarity

INF = np.inf


def test_starts_are_inside_and_finite_for_any_bounds():
    lower = [-1e308, 0.0, -INF, 5.0, 0.0, -INF, -7.0]
    upper = [1e308, 1e-8, -5.0, INF, INF, INF, -6.5]
    problem = lcp.MixedLCP(np.eye(7), np.ones(7), lower, upper)
    wang, kkt = lcp.WangHomotopy(problem).start()[0], lcp.KKTHomotopy(problem).start()[0]
    for x in (wang[:7], kkt[:7], lcp.random_start(problem, np.random.default_rng(0)).x0):
        assert ((x > problem.lower) & (x < problem.upper)).all()
    assert np.isfinite([*wang, *kkt]).all()
    np.testing.assert_array_equal(wang[:7], [0.0, 5e-9, -6.0, 6.0, 1.0, 0.0, -6.75])


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


@pytest.mark.parametrize(
    "problem",
    [EVERY_KIND, lcp.LCP(sp.csr_array(np.eye(40) + np.outer(np.eye(40)[0], np.ones(40))), -np.ones(40))],
    ids=["every kind", "a full row is not squared"],
)
@pytest.mark.parametrize("lam", [1.0, 0.5, 0.01])
def test_the_core_of_the_kkt_homotopy_that_is_not_corrected(lam, problem):
    homotopy = lcp.KKTHomotopy(problem, refine=False)
    system, whole, rhs = bordered_at(homotopy, homotopy.start()[0], lam, np.random.default_rng(0))
    np.testing.assert_allclose(system.solve(rhs[:-1], rhs[-1]), np.linalg.solve(whole, rhs), rtol=1e-8, atol=1e-9)
    assert system.sign == np.linalg.slogdet(whole)[0]


def test_the_kkt_equations_of_a_box_by_hand():
    """A = 2, q = -3 on [1, 4], x0 = 2, z1 = (5, 6), z2 = 1, (s0, t0) = (7, 8); rho = 7 - 8 - 1."""
    homotopy = lcp.KKTHomotopy(lcp.MixedLCP([[2.0]], [-3.0], 1, 4), [2.0], [5.0, 6.0], [1.0], [7.0, 8.0])
    # At x = 3, z1 = (1, 2), z2 = 2, t = 5, lambda = 1/4: w = 3, and 3 - 1/2 + 5 is what is complementary to z2.
    expected = [
        0.75 * (3 + 2 * (2 - 2) - 1 + 2) + 0.25 * (3 - 2), 1 * 2 - 0.25 * 5 * 1, 2 * 1 - 0.25 * 6 * 2,
        2 * 7.5 - 0.25 * 1 * 7, (3 - 2) * 5 - 0.25 * 2 * 8,
    ]  # fmt: skip
    np.testing.assert_allclose(homotopy.residual(np.array([3.0, 1.0, 2.0, 2.0, 5.0]), 0.25), expected, rtol=1e-15)
    # w = -1/2 at x = 5/4 presses against the upper bound.
    assert homotopy.observe(np.array([1.25, 1.0, 2.0, 2.0, 5.0]), 0.25)["gap"] == (1.25 - 4.0) * -0.5


@pytest.mark.parametrize("seed", range(3))
def test_an_end_of_the_kkt_path_is_stationary(seed):
    """Where A is not monotone the end may be no solution: it satisfies the conditions of order 2n all the same."""
    rng = np.random.default_rng(seed)
    homotopy = lcp.KKTHomotopy(lcp.MixedLCP(rng.standard_normal((6, 6)), rng.standard_normal(6), -1.0, 2.0))
    y = continuation.trace(homotopy).endpoint.y
    assert stationary(homotopy.problem, y)
    assert not stationary(homotopy.problem, y + 0.1)
    x, _, z, _ = homotopy.split(y)
    assert stationarity(homotopy.problem).relative_residual(np.append(x, z)) <= 1e-8


def test_both_solutions_of_kojima_and_shindo():
    problem, rng = MixedComplementarity(kojima_shindo, lower=np.zeros(4)), np.random.default_rng(0)
    found = [solve_complementarity(problem, 3.0 * rng.random(4) + 0.01) for _ in range(12)]
    assert all(solution.success for solution in found)
    solutions = {(1.0, 0.0, 3.0, 0.0), (round(np.sqrt(1.5), 12), 0.0, 0.0, 0.5)}
    assert {tuple(np.round(solution.x, 12)) for solution in found} == solutions


@pytest.mark.parametrize("jacobian", [None, lambda x: np.diag(np.exp(x)), lambda x: sp.diags_array(np.exp(x)).tocsr()])
def test_a_nonlinear_problem_with_bounds(jacobian):
    problem = MixedComplementarity(exponential, jacobian, **BOX)
    wanted = [np.log(2.0), 0.0, np.log(3.0), np.log(1.5), 1.0]
    solution = solve_complementarity(problem)
    np.testing.assert_allclose(solution.x, wanted, atol=1e-15)
    assert solution.certificate.relative_residual <= 1e-15
    path = path_of(InteriorHomotopy(problem))
    np.testing.assert_allclose(path.endpoint.y[:5], wanted, atol=1e-8)
