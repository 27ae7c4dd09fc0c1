"""The LCP homotopies: their equations, derivatives, reductions, series and starts."""

from __future__ import annotations

import pickle
import tracemalloc
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import continuation
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.jets import path_series
from continuation.linear import Banded
from continuation.linear.symmetric import Cholesky
from continuation.point.linearization import Linearization, linearize
from problems.lcp.data.problem import LCP
from problems.lcp.homotopies import (
    KKTHomotopy,
    KojimaMegiddoMizunoHomotopy,
    Structure,
    WangHomotopy,
    XuHomotopy,
    YuHomotopy,
    ZhaoHomotopy,
    default_start,
    random_start,
)
from problems.lcp.homotopies.interior import RelativeMetric
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.proof.phase1 import NoStrictlyFeasiblePoint
from problems.lcp.strategies import lcps, matrices
from problems.paper import EXAMPLES

TWO_VECTOR = (YuHomotopy, ZhaoHomotopy, XuHomotopy, WangHomotopy, KojimaMegiddoMizunoHomotopy)
ALL = (KKTHomotopy, *TWO_VECTOR)
every = pytest.mark.parametrize("make", ALL, ids=lambda make: make.__name__)


def made(make: Callable[..., Any], problem: LCP, rng: np.random.Generator) -> Any:
    """A homotopy with a start in general position, not feasible."""
    x0, other = rng.uniform(0.5, 2.0, (2, problem.n))
    return make(problem, x0, w0=other) if make is KKTHomotopy else make(problem, x0, other)


def interior(rng: np.random.Generator, homotopy: Any, span: float) -> tuple[np.ndarray, float]:
    """Positive unknowns between 10^-span and 10^span, and a parameter between 10^-span and 1."""
    size = homotopy.start()[0].size
    return 10.0 ** rng.uniform(-span, span, size), float(10.0 ** rng.uniform(-span, 0.0))


def full_matrix(homotopy: Any, y: np.ndarray, lam: float, border: np.ndarray) -> np.ndarray:
    H_y, H_lam = homotopy.jacobian(y, lam)
    H_y = H_y.toarray() if sp.issparse(H_y) else H_y
    return np.block([[H_y, H_lam[:, None]], [border[None, :]]])


def random_lcp(rng: np.random.Generator, n: int, kind: str = "any") -> LCP:
    B = rng.standard_normal((n, n))
    A = {"any": B, "symmetric psd": B @ B.T, "psd": B @ B.T + B - B.T}[kind]
    return LCP(A, rng.standard_normal(n))


def linearized(homotopy: Any, y: np.ndarray, lam: float) -> Linearization:
    u = np.append(y, lam)
    weights = homotopy.metric.weights(u, u, None)
    reference = np.zeros_like(u)
    reference[-1] = -1.0
    return linearize(Evaluator(homotopy, Counts()), u, weights, reference, 0)


# --- the equations and their derivatives -------------------------------------------------------------------


def test_kkt_equations_by_hand() -> None:
    homotopy = KKTHomotopy(LCP([[2.0]], [-3.0]), [1.0], [5.0], [7.0], [4.0])
    # rho = 4 - (2 - 3) = 5, c1 = 5, c2 = 28; at x = 2, z1 = 3, z2 = 6, lambda = 1/4: w = 1 + 5/4.
    expected = [0.75 * (4 * 2 - 3 - 3 - 2 * 6) + 0.25 * (2 - 1), 3 * 2 - 0.25 * 5, 6 * 2.25 - 0.25 * 28]
    assert homotopy.residual(np.array([2.0, 3.0, 6.0]), 0.25) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("make", "first"),
    [
        (YuHomotopy, 0.75 * (1 - 6) + 0.25 * (2 - 1)),
        (ZhaoHomotopy, 0.75 * (6 - 1) + 0.25 * (2 - 1)),
        (XuHomotopy, 0.75 * (6 - 1) - 0.25 * (2 - 1)),
        (WangHomotopy, 0.75 * 1 - 6 + 0.25 * 4),
        (KojimaMegiddoMizunoHomotopy, 1 - 6 + 0.25 * (4 - (-1))),
    ],
)
def test_two_vector_equations_by_hand(make: Callable[..., Any], first: float) -> None:
    homotopy = make(LCP([[2.0]], [-3.0]), [1.0], [4.0])
    # x = 2, y = 6, lambda = 1/4: A x + q = 1.
    assert homotopy.residual(np.array([2.0, 6.0]), 0.25) == pytest.approx([first, 2 * 6 - 0.25 * 4], rel=1e-15)


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_jacobian_and_differential(make: Callable[..., Any], problem: LCP, seed: int) -> None:
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


# --- the reduction -----------------------------------------------------------------------------------------


def exact_solution(M: np.ndarray, rhs: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """The solution, its sensitivity to relative changes of the entries by one unit, and the determinant's sign."""
    with mpmath.workdps(90):
        matrix = mpmath.matrix(M.tolist())
        inverse = matrix**-1
        z = inverse * mpmath.matrix(rhs.tolist())
        sign = int(mpmath.sign(mpmath.det(matrix)))
        inverse_entries = np.array([[abs(float(e)) for e in row] for row in inverse.tolist()])
        solution = np.array([float(e) for e in z])
    return solution, inverse_entries @ (np.abs(M) @ np.abs(solution) + np.abs(rhs)), sign


@every
@pytest.mark.parametrize("span", [1, 6, 12])
@pytest.mark.parametrize("kind", ["any", "symmetric psd", "psd"])
def test_bordered_solve_is_accurate_component_by_component(make: Callable[..., Any], span: int, kind: str) -> None:
    """Against 90 digits: to 1e-13, or to what a rounding of the entries does to the component (Skeel)."""
    rng = np.random.default_rng(span)
    for _ in range(4):
        n = int(rng.integers(1, 5))
        homotopy = made(make, random_lcp(rng, n, kind), rng)
        y, lam = interior(rng, homotopy, span)
        border, rhs = rng.standard_normal((2, y.size + 1))
        system = homotopy.bordered(y, lam, border)
        z = system.solve(rhs[:-1], rhs[-1])
        solution, sensitivity, sign = exact_solution(full_matrix(homotopy, y, lam, border), rhs)
        assert (np.abs(z - solution) <= 1e-13 * np.abs(solution) + 1e-15 * sensitivity).all()
        assert system.sign == sign


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1), span=st.sampled_from([0.5, 3.0, 9.0]))
@settings(max_examples=100, deadline=None)
def test_bordered_solve_has_a_small_backward_error(
    make: Callable[..., Any], problem: LCP, seed: int, span: float
) -> None:
    """On integer matrices, singular ones among them; the tangent's orientation agrees with the full determinant."""
    rng = np.random.default_rng(seed)
    homotopy = made(make, problem, rng)
    y, lam = interior(rng, homotopy, span)
    border, rhs = rng.standard_normal((2, y.size + 1))
    M = full_matrix(homotopy, y, lam, border)
    equilibrated = M / np.abs(M).max(axis=1, keepdims=True)
    equilibrated /= np.abs(equilibrated).max(axis=0)
    assume(np.linalg.cond(equilibrated) < 1e10)
    system = homotopy.bordered(y, lam, border)
    z = system.solve(rhs[:-1], rhs[-1])
    assert (np.abs(M @ z - rhs) <= 1e-12 * (np.abs(M) @ np.abs(z) + np.abs(rhs))).all()
    assert system.sign == np.linalg.slogdet(equilibrated)[0]


@every
def test_an_approximate_solve_is_one_of_the_core_and_makes_refinement_contract(make: Callable[..., Any]) -> None:
    """Close to the boundary too, where the core alone loses digits."""
    rng = np.random.default_rng(6)
    for span in (0.5, 3.0, 8.0):
        homotopy = made(make, random_lcp(rng, 6), rng)
        y, lam = interior(rng, homotopy, span)
        border, rhs = rng.standard_normal((2, y.size + 1))
        M = full_matrix(homotopy, y, lam, border)
        system = homotopy.bordered(y, lam, border)
        assert system.sign in (-1, 1)
        alone = system._probe.core.solve(rhs[:-1], rhs[-1])
        assert np.array_equal(system.approximate(rhs[:-1], rhs[-1]), alone)
        z, exact = np.zeros(y.size + 1), system.solve(rhs[:-1], rhs[-1])
        for _ in range(4):
            before = np.abs((z - exact) / y_and_parameter(y)).max()
            r = rhs - M @ z
            z = z + system.approximate(r[:-1], r[-1])
            after = np.abs((z - exact) / y_and_parameter(y)).max()
            assert after <= max(1e-2 * before, 1e-9 * np.abs(exact / y_and_parameter(y)).max())


def y_and_parameter(y: np.ndarray) -> np.ndarray:
    """The units of the unknowns and of the parameter."""
    return np.append(np.abs(y), 1.0)


@every
def test_components_that_are_zero(make: Callable[..., Any]) -> None:
    """On the boundary, where the end of a path lies, the reduction divides by nothing that is zero."""
    rng = np.random.default_rng(3)
    homotopy = made(make, random_lcp(rng, 3), rng)
    y, lam = interior(rng, homotopy, 0.5)
    y[0] = 0.0
    y[4] = 0.0
    border, rhs = rng.standard_normal((2, y.size + 1))
    M = full_matrix(homotopy, y, lam, border)
    system = homotopy.bordered(y, lam, border)
    assert np.allclose(system.solve(rhs[:-1], rhs[-1]), np.linalg.solve(M, rhs), rtol=1e-11)
    assert system.sign == np.linalg.slogdet(M)[0]


@every
def test_factorisation_outlives_a_change_of_its_point(make: Callable[..., Any]) -> None:
    rng = np.random.default_rng(4)
    homotopy = made(make, random_lcp(rng, 3), rng)
    y, lam = interior(rng, homotopy, 2.0)
    border, rhs = rng.standard_normal((2, y.size + 1))
    M = full_matrix(homotopy, y, lam, border)
    system = homotopy.bordered(y, lam, border)
    y += 1.0
    border += 1.0
    assert np.allclose(system.solve(rhs[:-1], rhs[-1]), np.linalg.solve(M, rhs), rtol=1e-8)
    assert "robust" not in vars(system) or system.quick is None


def test_without_refinement_the_quick_core_answers_alone() -> None:
    rng = np.random.default_rng(1)
    problem = random_lcp(rng, 5, "symmetric psd")
    structure, start = Structure(problem), default_start(problem)
    for name in ("kkt", "yu"):
        refined, alone = (HOMOTOPIES[name].at(problem, start, structure, refine) for refine in (True, False))
        y, lam = interior(rng, refined, 0.5)
        border, rhs = rng.standard_normal((2, y.size + 1))
        system = refined.bordered(y, lam, border)
        z = alone.bordered(y, lam, border).solve(rhs[:-1], rhs[-1])
        np.testing.assert_array_equal(z, system.quick.solve(rhs[:-1], rhs[-1]))
        np.testing.assert_allclose(z, system.solve(rhs[:-1], rhs[-1]), rtol=1e-8)


def test_w_that_is_zero() -> None:
    homotopy = KKTHomotopy(LCP([[1.0, 2.0], [0.0, 1.0]], [-3.0, 1.0]), [1.0, 1.5])
    y = np.array([1.0, 1.0, 2.0, 1.0, 1.0, 1.0])
    assert homotopy.problem.w(y[:2])[0] == 0.0
    border = np.arange(1.0, 8.0)
    M = full_matrix(homotopy, y, 0.0, border)
    system = homotopy.bordered(y, 0.0, border)
    assert np.allclose(M @ system.solve(np.ones(6), 2.0), [1, 1, 1, 1, 1, 1, 2], rtol=1e-13)
    assert system.sign == np.linalg.slogdet(M)[0]


def test_singular_matrix_is_said_to_be_singular() -> None:
    homotopy = WangHomotopy(LCP([[1.0]], [1.0]))
    with pytest.raises(ArithmeticError, match=r"singular|not finite"):
        homotopy.bordered(np.zeros(2), 0.0, np.array([1.0, 0.0, 0.0])).solve(np.ones(2), 1.0)


# --- structure ---------------------------------------------------------------------------------------------


@given(A=matrices("PSD", n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_psd_matrix_gives_cholesky(A: np.ndarray, seed: int) -> None:
    """G is positive definite wherever x, z1, z2, w > 0, whatever the rank of A."""
    rng = np.random.default_rng(seed)
    homotopy = made(KKTHomotopy, LCP(A, np.ones(len(A))), rng)
    assert homotopy.structure.semidefinite
    n = len(A)
    y, lam = homotopy.start()[0], 0.9
    y[n:] *= rng.uniform(0.2, 5.0, 2 * n)
    w = homotopy.problem.w(y[:n]) + lam * homotopy.rho
    assume((w > 0.05).all())
    system = homotopy.bordered(y, lam, rng.standard_normal(y.size + 1))
    assert isinstance(system.quick.core.factor, Cholesky)
    D1, D2 = np.diag(y[n : 2 * n] / y[:n]), np.diag(y[2 * n :] / w)
    G = (1 - lam) * (A + A.T + D1 + A.T @ D2 @ A) + lam * np.eye(n)
    assert np.linalg.eigvalsh(G).min() > 0.0
    assert np.allclose(system.quick.core.bordered.matrix.matrix, G, rtol=1e-12)


@pytest.mark.parametrize("make", [YuHomotopy, WangHomotopy, KojimaMegiddoMizunoHomotopy, XuHomotopy])
def test_symmetric_psd_matrix_gives_cholesky(make: Callable[..., Any]) -> None:
    rng = np.random.default_rng(0)
    homotopy = made(make, random_lcp(rng, 6, "symmetric psd"), rng)
    y, lam = interior(rng, homotopy, 0.5)
    assert isinstance(homotopy.bordered(y, lam, np.ones(13)).quick.core.factor, Cholesky)
    nonsymmetric = made(make, random_lcp(rng, 6, "psd"), rng)
    assert nonsymmetric.bordered(y, lam, np.ones(13)).quick is None


def test_what_is_taken_for_semidefinite() -> None:
    assert Structure(LCP([[1.0, 5.0], [-5.0, 0.0]], [0, 0])).semidefinite
    assert Structure(LCP([[1.0, -1.0], [-1.0, 1.0]], [0, 0])).semidefinite
    assert Structure(LCP([[1e-8, 0.0], [0.0, 1e8]], [0, 0])).semidefinite
    assert not Structure(LCP([[1.0, 2.0], [1.0, 1.0]], [0, 0])).semidefinite
    assert not Structure(LCP([[0.0, 1e-6], [0.0, 0.0]], [0, 0])).semidefinite
    assert Structure(LCP(sp.csr_array(np.array([[2.0, -1.0], [-1.0, 2.0]])), [0, 0])).semidefinite
    assert not Structure(LCP(sp.csr_array(np.array([[1.0, -2.0], [-1.0, 2.0]])), [0, 0])).semidefinite


def sparse_examples(rng: np.random.Generator) -> dict[str, sp.csr_array]:
    n = 40
    band = sp.diags_array(
        [rng.standard_normal(n - 2), rng.standard_normal(n), rng.standard_normal(n - 1)], offsets=[-2, 0, 1]
    )
    scattered = sp.random_array((n, n), density=0.08, rng=rng) + sp.diags_array(rng.standard_normal(n))
    arrow = sp.lil_array((n, n))
    arrow.setdiag(rng.standard_normal(n))
    arrow[0, :] = rng.standard_normal(n)
    return {"banded": sp.csr_array(band), "scattered": sp.csr_array(scattered), "full row": sp.csr_array(arrow)}


@every
@pytest.mark.parametrize("kind", ["banded", "scattered", "full row"])
def test_sparse_and_banded_agree_with_dense(make: Callable[..., Any], kind: str) -> None:
    rng = np.random.default_rng(7)
    A, q = sparse_examples(rng)[kind], rng.standard_normal(40)
    sparse, dense = LCP(A, q), LCP(A.toarray(), q)
    one, other = made(make, sparse, np.random.default_rng(1)), made(make, dense, np.random.default_rng(1))
    y, lam = interior(rng, one, 0.7)
    border, rhs = rng.standard_normal((2, y.size + 1))
    assert np.allclose(one.residual(y, lam), other.residual(y, lam), rtol=1e-12, atol=1e-12)
    assert sp.issparse(one.jacobian(y, lam)[0])
    assert np.allclose(full_matrix(one, y, lam, border), full_matrix(other, y, lam, border), rtol=1e-14)
    systems = [homotopy.bordered(y, lam, border) for homotopy in (one, other)]
    z, expected = (system.solve(rhs[:-1], rhs[-1]) for system in systems)
    assert np.allclose(z, expected, rtol=1e-9, atol=1e-10 * np.abs(expected).max())
    assert systems[0].sign == systems[1].sign
    assert np.allclose(
        systems[0].robust.solve(rhs[:-1], rhs[-1]), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()
    )
    assert systems[0].robust.sign == systems[1].sign


def test_which_form_a_sparse_matrix_gets() -> None:
    rng = np.random.default_rng(7)
    forms = {name: Structure(LCP(A, np.ones(40))) for name, A in sparse_examples(rng).items()}
    assert isinstance(forms["banded"].scaled(1.0, np.ones(40), np.ones(40)), Banded)
    assert isinstance(forms["banded"].normal(1.0, np.ones(40), np.ones(40)), Banded)
    assert forms["scattered"].band is None
    assert forms["scattered"].squarable
    assert not forms["full row"].squarable


@pytest.mark.parametrize("make", [KKTHomotopy, WangHomotopy])
def test_tridiagonal_problem_costs_no_dense_array(make: Callable[..., Any]) -> None:
    n = 100_000
    off = np.full(n - 1, -1.0)
    problem = LCP(sp.diags_array([off, np.full(n, 2.0), off], offsets=[-1, 0, 1]), np.sin(np.arange(n)) - 0.3)
    homotopy = make(problem)
    rng = np.random.default_rng(0)
    y = homotopy.start()[0]
    y *= rng.uniform(0.8, 1.2, y.size)
    border, rhs = rng.standard_normal((2, y.size + 1))
    tracemalloc.start()
    system = homotopy.bordered(y, 0.9, border)
    z = system.solve(rhs[:-1], rhs[-1])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 400e6, "a few dozen vectors, where a dense matrix takes 8e10 bytes"
    assert np.abs(homotopy.differential(y, 0.9, z) - rhs[:-1]).max() < 1e-9 * np.abs(z).max()
    assert float(border @ z) == pytest.approx(rhs[-1], abs=1e-9 * np.abs(z).max())


# --- series, steps, metric ---------------------------------------------------------------------------------


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_taylor_agrees_with_jets(make: Callable[..., Any], problem: LCP, seed: int) -> None:
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


@every
def test_taylor_residual_falls_with_the_order(make: Callable[..., Any]) -> None:
    """H(u(s)) - H(u(0)) = O(s^(K + 1)): half the step divides it by 2^(K + 1)."""
    rng = np.random.default_rng(5)
    homotopy = made(make, random_lcp(rng, 5, "psd"), rng)
    y = homotopy.start()[0]
    point = linearized(homotopy, y * rng.uniform(0.9, 1.1, y.size), 0.9)
    order = 6
    c = homotopy.taylor(point, order)
    radius = 1.0 / np.max(np.abs(c[order]) ** (1.0 / order))
    base = homotopy.residual(point.y, point.lam)

    def defect(s: float) -> float:
        u = np.polynomial.polynomial.polyval(s, c)
        return float(np.abs(homotopy.residual(u[:-1], u[-1]) - base).max())

    assert defect(0.08 * radius) / defect(0.04 * radius) == pytest.approx(2.0 ** (order + 1), rel=0.3)
    along = c[1:] @ point.border
    assert np.allclose(along, np.eye(order)[0], atol=1e-10 * np.abs(c[1:]).max(axis=1))


@pytest.mark.parametrize("order", [0, 1])
def test_taylor_of_low_order(order: int) -> None:
    homotopy = KKTHomotopy(LCP(np.eye(2), [1.0, -1.0]))
    y, lam = homotopy.start()
    point = linearized(homotopy, y, lam)
    assert np.array_equal(homotopy.taylor(point, order), np.array([point.u, point.tangent])[: order + 1])


def positives(homotopy: Any, u: np.ndarray) -> np.ndarray:
    if isinstance(homotopy, KKTHomotopy):
        return np.append(u[:-1], homotopy.problem.w(u[: homotopy.n]) + u[-1] * homotopy.rho)
    return u[:-1]


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=100, deadline=None)
def test_max_step_is_sharp(make: Callable[..., Any], problem: LCP, seed: int) -> None:
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


def test_max_step_from_the_boundary_is_zero() -> None:
    homotopy = WangHomotopy(LCP([[1.0]], [1.0]))
    assert homotopy.max_step(np.array([0.0, 1.0, 0.5]), np.array([-1.0, 0.0, 0.0])) == 0.0
    assert homotopy.max_step(np.array([0.0, 1.0, 0.5]), np.array([1.0, 0.0, 0.0])) == np.inf


def test_relative_metric() -> None:
    metric = RelativeMetric(lam=3.0)
    u = np.array([2.0, -0.5, 4.0, 0.3])
    weights = metric.weights(u, u, None)
    assert weights == pytest.approx([1 / 12, 4 / 3, 1 / 48, 3.0])
    after = metric.weights(np.array([1.0, 0.0, 8.0, 0.0]), u, weights)
    assert after == pytest.approx([1 / 3, 1 / (3 * (1e-3 * 0.5) ** 2), 1 / 192, 3.0])


def test_observe() -> None:
    homotopy = KKTHomotopy(LCP([[1.0, 0.0], [0.0, 1.0]], [-1.0, 2.0]))
    assert homotopy.observe(np.array([1.5, 0.25, 9, 9, 9, 9.0]), 0.1) == {"natural_residual": 0.5, "gap": 1.3125}


# --- starts ------------------------------------------------------------------------------------------------


@given(problem=lcps(), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_starts_are_on_the_path(problem: LCP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    another = random_start(problem, rng)
    tries = [
        KKTHomotopy(problem),
        KKTHomotopy(problem, another.x0, another.z1, another.z2, another.w0),
        *(made(make, problem, rng) for make in ALL),
        YuHomotopy(problem),
        WangHomotopy(problem),
        KojimaMegiddoMizunoHomotopy(problem),
    ]
    for homotopy in tries:
        y, lam = homotopy.start()
        assert lam == 1.0
        assert (y > 0.0).all()
        size = 1.0 + np.abs(y).max() ** 2
        assert np.abs(homotopy.residual(y, lam)).max() <= 1e-14 * size
        assert homotopy.max_step(np.append(y, lam), np.zeros(y.size + 1)) == np.inf


def test_the_papers_start_is_kept() -> None:
    for example in EXAMPLES:
        homotopy = KKTHomotopy(example.problem, example.x0)
        assert not homotopy.rho.any()
        assert np.array_equal(homotopy.start()[0], np.concatenate([example.x0, example.z1, example.z2]))


def test_relaxed_start() -> None:
    problem = LCP([[1.0, 0.0], [0.0, 1.0]], [-3.0, 2.0])
    homotopy = KKTHomotopy(problem, [1.0, 1.0])
    assert np.array_equal(homotopy.origin.w0, [3.0, 6.0])
    assert np.array_equal(homotopy.rho, [5.0, 3.0])
    assert np.ptp(np.append(homotopy.c1, homotopy.c2)) < 1e-15 * homotopy.c1[0]
    given_w0 = KKTHomotopy(problem, [1.0, 1.0], w0=[1.0, 2.0])
    assert np.array_equal(given_w0.origin.w0, [1.0, 2.0])


def test_default_start_has_the_units_of_the_problem() -> None:
    A, q = np.array([[2.0, 1.0], [0.0, 3.0]]), np.array([-4.0, 1.0])
    start, scaled = default_start(LCP(A, q)), default_start(LCP(1e6 * A, 1e2 * q))
    assert np.allclose(scaled.x0, 1e-4 * start.x0)
    assert np.allclose(scaled.w0, 1e2 * start.w0)
    assert default_start(LCP(np.zeros((2, 2)), [0.0, 0.0])).x0 == pytest.approx([1.0, 1.0])


def test_random_starts_are_reproducible() -> None:
    problem = EXAMPLES[4].problem
    one, two = (random_start(problem, np.random.default_rng(11)) for _ in range(2))
    assert np.array_equal(one.x0, two.x0)
    assert np.array_equal(one.w0, two.w0)


@pytest.mark.parametrize("make", [ZhaoHomotopy, XuHomotopy])
def test_feasible_starts(make: Callable[..., Any]) -> None:
    example = EXAMPLES[1]
    assert np.array_equal(make(example.problem, example.x0).y0, example.problem.w(example.x0))
    found = make(example.problem)
    assert np.array_equal(found.y0, example.problem.w(found.x0))
    with pytest.raises(ValueError, match=r"x0: expected A x0 \+ q > 0"):
        make(example.problem, [0.1, 0.1])
    with pytest.raises(NoStrictlyFeasiblePoint):
        make(LCP([[-1.0]], [-1.0]))


def test_published_products() -> None:
    """Yu: x y = lambda e."""
    assert np.allclose(YuHomotopy(EXAMPLES[0].problem, EXAMPLES[0].x0).c, 1.0)


@every
@pytest.mark.parametrize(
    ("argument", "value", "found"),
    [
        ("x0", [1.0, -1.0], "-1.0 at index 1"),
        ("x0", [1.0, np.nan], "nan at index 1"),
        ("x0", [1.0], r"shape \(1,\)"),
        ("x0", ["a", "b"], "dtype"),
        ("other", [np.inf, 1.0], "inf at index 0"),
    ],
)
def test_bad_starts(make: Callable[..., Any], argument: str, value: list[Any], found: str) -> None:
    name = argument if argument == "x0" else ("w0" if make is KKTHomotopy else "y0")
    with pytest.raises(ValueError, match=f"{name}: expected .* found {found}|{name}: expected .* found .*{found}"):
        make(EXAMPLES[1].problem, **{"x0": [2.0, 1.0], name: value})


@every
def test_bad_problem(make: Callable[..., Any]) -> None:
    with pytest.raises(TypeError, match="problem: expected an LCP, found tuple"):
        make((np.eye(2), np.ones(2)))


@every
def test_pickle_and_sharing(make: Callable[..., Any]) -> None:
    rng = np.random.default_rng(2)
    homotopy = made(make, random_lcp(rng, 4), rng)
    y, lam = interior(rng, homotopy, 0.5)
    border = rng.standard_normal(y.size + 1)
    homotopy.bordered(y, lam, border)
    twin = pickle.loads(pickle.dumps(homotopy))
    assert np.array_equal(twin.residual(y, lam), homotopy.residual(y, lam))
    other = {"w0" if make is KKTHomotopy else "y0": np.ones(4)}
    sibling = make(homotopy.problem, np.ones(4), **other, structure=homotopy.structure)
    assert sibling.structure is homotopy.structure


# --- traced ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [1, 2, 3, 4, 5, 6, 9])
def test_kkt_paths_end_at_the_printed_solution(number: int) -> None:
    example = EXAMPLES[number - 1]
    path = continuation.trace(KKTHomotopy(example.problem, example.x0))
    assert path.status is continuation.Status.REACHED_TARGET
    exact = np.array([float(v) for v in example.solutions[0]])
    assert np.abs(path.endpoint.y[: exact.size] - exact).max() < 1e-8


SOLVED = [(YuHomotopy, (2, 3, 4, 5, 6)), (XuHomotopy, (2, 3, 4, 5, 6)), (WangHomotopy, (2, 3, 4, 6))]


@pytest.mark.parametrize(("make", "numbers"), SOLVED)
def test_older_homotopies_solve_what_they_can_and_diverge_elsewhere(
    make: Callable[..., Any], numbers: tuple[int, ...]
) -> None:
    for number in (1, *numbers, 9):
        problem = EXAMPLES[number - 1].problem
        path = continuation.trace(make(problem, EXAMPLES[number - 1].x0))
        if number in numbers:
            assert path.status is continuation.Status.REACHED_TARGET
            assert problem.natural_residual(path.endpoint.y[: problem.n]) < 1e-8
        else:
            assert path.status is continuation.Status.DIVERGED
