"""The LCP homotopies: their equations, derivatives, series and steps."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import continuation
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.jets import path_series
from continuation.point.linearization import linearize
from problems import lcp
from problems.lcp.homotopies.interior import RelativeMetric
from problems.lcp.strategies import lcps
from problems.paper import EXAMPLES

from .util import every, full_matrix, interior, made


def linearized(homotopy, y, lam):
    u = np.append(y, lam)
    weights = homotopy.metric.weights(u, u, None)
    reference = np.zeros_like(u)
    reference[-1] = -1.0
    return linearize(Evaluator(homotopy, Counts()), u, weights, reference)


def test_kkt_equations_by_hand():
    homotopy = lcp.KKTHomotopy(lcp.LCP([[2.0]], [-3.0]), [1.0], [5.0], [7.0], [4.0])
    # rho = 4 - (2 - 3) = 5, c1 = 5, c2 = 28; at x = 2, z1 = 3, z2 = 6, lambda = 1/4: w = 1 + 5/4.
    expected = [0.75 * (4 * 2 - 3 - 3 - 2 * 6) + 0.25 * (2 - 1), 3 * 2 - 0.25 * 5, 6 * 2.25 - 0.25 * 28]
    assert homotopy.residual(np.array([2.0, 3.0, 6.0]), 0.25) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("make", "first"),
    [
        (lcp.YuHomotopy, 0.75 * (1 - 6) + 0.25 * (2 - 1)),
        (lcp.ZhaoHomotopy, 0.75 * (6 - 1) + 0.25 * (2 - 1)),
        (lcp.XuHomotopy, 0.75 * (6 - 1) - 0.25 * (2 - 1)),
        (lcp.WangHomotopy, 0.75 * 1 - 6 + 0.25 * 4),
        (lcp.KojimaMegiddoMizunoHomotopy, 1 - 6 + 0.25 * (4 - (-1))),
    ],
)
def test_two_vector_equations_by_hand(make, first):
    homotopy = make(lcp.LCP([[2.0]], [-3.0]), [1.0], [4.0])
    # x = 2, y = 6, lambda = 1/4: A x + q = 1.
    assert homotopy.residual(np.array([2.0, 6.0]), 0.25) == pytest.approx([first, 2 * 6 - 0.25 * 4], rel=1e-15)


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_jacobian_and_differential(make, problem, seed):
    """H is quadratic in (y, lambda), so that central differences of any width are exact."""
    rng = np.random.default_rng(seed)
    homotopy = made(make, problem, rng)
    y, lam = interior(rng, homotopy, 0.5)
    v = rng.standard_normal(y.size + 1)
    M = full_matrix(homotopy, y, lam, v)
    ahead, behind = homotopy.residual(y + v[:-1], lam + v[-1]), homotopy.residual(y - v[:-1], lam - v[-1])
    scale = 1e-13 * (1.0 + np.abs(ahead).max() + np.abs(behind).max())
    assert np.allclose(M[:-1] @ v, (ahead - behind) / 2.0, rtol=0, atol=scale)
    assert np.allclose(homotopy.differential(y, lam, v), M[:-1] @ v, rtol=0, atol=scale)


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_taylor_agrees_with_jets(make, problem, seed):
    rng = np.random.default_rng(seed)
    homotopy = made(make, problem, rng)
    y, lam = homotopy.start()
    point = linearized(homotopy, y * rng.uniform(0.9, 1.1, y.size), lam - 0.1)
    assume(np.linalg.cond(full_matrix(homotopy, point.y, point.lam, point.border)) < 1e6)
    order = 9
    c = homotopy.taylor(point, order)
    expected = path_series(homotopy.residual, point.u, point.tangent, point.solve, order)
    scale = np.abs(expected).max(axis=1, keepdims=True)
    assert np.allclose(c / scale, expected / scale, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("order", [0, 1])
def test_taylor_of_low_order(order):
    homotopy = lcp.KKTHomotopy(lcp.LCP(np.eye(2), [1.0, -1.0]))
    y, lam = homotopy.start()
    point = linearized(homotopy, y, lam)
    assert np.array_equal(homotopy.taylor(point, order), np.array([point.u, point.tangent])[: order + 1])


def positives(homotopy, u):
    if isinstance(homotopy, lcp.KKTHomotopy):
        return np.append(u[:-1], homotopy.problem.w(u[: homotopy.n]) + u[-1] * homotopy.rho)
    return u[:-1]


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=100, deadline=None)
def test_max_step_is_sharp(make, problem, seed):
    rng = np.random.default_rng(seed)
    homotopy = made(make, problem, rng)
    u = np.append(homotopy.start()[0], 1.0)
    v = rng.standard_normal(u.size)
    h = homotopy.max_step(u, v)
    if np.isinf(h):
        assert (positives(homotopy, u + 1e6 * v) > 0.0).all()
    else:
        assert h > 0.0
        assert (positives(homotopy, u + h * (1 - 1e-9) * v) > 0.0).all()
        assert not (positives(homotopy, u + h * (1 + 1e-9) * v) > 0.0).all()


def test_max_step_from_the_boundary_is_zero():
    homotopy = lcp.WangHomotopy(lcp.LCP([[1.0]], [1.0]))
    assert homotopy.max_step(np.array([0.0, 1.0, 0.5]), np.array([-1.0, 0.0, 0.0])) == 0.0
    assert homotopy.max_step(np.array([0.0, 1.0, 0.5]), np.array([1.0, 0.0, 0.0])) == np.inf


def test_relative_metric():
    metric = RelativeMetric(lam=3.0)
    u = np.array([2.0, -0.5, 4.0, 0.3])
    weights = metric.weights(u, u, None)
    assert weights == pytest.approx([1 / 12, 4 / 3, 1 / 48, 3.0])
    after = metric.weights(np.array([1.0, 0.0, 8.0, 0.0]), u, weights)
    assert after == pytest.approx([1 / 3, 1 / (3 * (1e-3 * 0.5) ** 2), 1 / 192, 3.0])


def test_observe():
    homotopy = lcp.KKTHomotopy(lcp.LCP([[1.0, 0.0], [0.0, 1.0]], [-1.0, 2.0]))
    assert homotopy.observe(np.array([1.5, 0.25, 9, 9, 9, 9.0]), 0.1) == {"natural_residual": 0.5, "gap": 1.3125}


def test_published_products():
    """Yu: x y = lambda e."""
    assert np.allclose(lcp.YuHomotopy(EXAMPLES[0].problem, EXAMPLES[0].x0).c, 1.0)


@every
def test_the_structure_of_a_matrix_is_shared(make):
    structure = lcp.Structure(lcp.LCP(np.eye(4), np.ones(4)))
    other = {"w0" if make is lcp.KKTHomotopy else "y0": np.ones(4)}
    assert make(structure.problem, np.ones(4), **other, structure=structure).structure is structure


SOLVED = [(lcp.YuHomotopy, (2, 3, 4, 5, 6)), (lcp.XuHomotopy, (2, 3, 4, 5, 6)), (lcp.WangHomotopy, (2, 3, 4, 6))]


@pytest.mark.parametrize(("make", "numbers"), SOLVED)
def test_older_homotopies_solve_what_they_can_and_diverge_elsewhere(make, numbers):
    for number in (1, *numbers, 9):
        problem = EXAMPLES[number - 1].problem
        path = continuation.trace(make(problem, EXAMPLES[number - 1].x0))
        if number in numbers:
            assert path.status is continuation.Status.REACHED_TARGET
            assert problem.natural_residual(path.endpoint.y[: problem.n]) < 1e-8
        else:
            assert path.status is continuation.Status.DIVERGED
