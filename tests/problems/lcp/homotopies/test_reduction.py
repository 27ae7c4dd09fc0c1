"""The reduction of a bordered system to its core: accuracy, structure, and what is singular."""

import tracemalloc

import mpmath
import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from continuation.linear import Banded
from continuation.linear.symmetric import Cholesky
from problems import lcp
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.strategies import lcps, matrices

from .util import bordered_at, every, full_matrix, interior, made, random_lcp


def exact_solution(M, rhs):
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
def test_bordered_solve_is_accurate_component_by_component(make, span, kind):
    """Against 90 digits: to 1e-13, or to what a rounding of the entries does to the component (Skeel)."""
    rng = np.random.default_rng(span)
    for _ in range(4):
        n = int(rng.integers(1, 5))
        homotopy = made(make, random_lcp(rng, n, kind), rng)
        y, lam = interior(rng, homotopy, span)
        system, M, rhs = bordered_at(homotopy, y, lam, rng)
        z = system.solve(rhs[:-1], rhs[-1])
        solution, sensitivity, sign = exact_solution(M, rhs)
        assert (np.abs(z - solution) <= 1e-13 * np.abs(solution) + 1e-15 * sensitivity).all()
        assert system.sign == sign


@every
@given(problem=lcps(n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1), span=st.sampled_from([0.5, 3.0, 9.0]))
@settings(max_examples=100, deadline=None)
def test_bordered_solve_has_a_small_backward_error(make, problem, seed, span):
    """On integer matrices, singular ones among them; the tangent's orientation agrees with the full determinant."""
    rng = np.random.default_rng(seed)
    homotopy = made(make, problem, rng)
    y, lam = interior(rng, homotopy, span)
    system, M, rhs = bordered_at(homotopy, y, lam, rng)
    equilibrated = M / np.abs(M).max(axis=1, keepdims=True)
    equilibrated /= np.abs(equilibrated).max(axis=0)
    assume(np.linalg.cond(equilibrated) < 1e10)
    z = system.solve(rhs[:-1], rhs[-1])
    assert (np.abs(M @ z - rhs) <= 1e-12 * (np.abs(M) @ np.abs(z) + np.abs(rhs))).all()
    assert system.sign == np.linalg.slogdet(equilibrated)[0]


@every
def test_an_approximate_solve_is_one_of_the_core_and_makes_refinement_contract(make):
    """Close to the boundary too, where the core alone loses digits."""
    rng = np.random.default_rng(6)
    for span in (0.5, 3.0, 8.0):
        homotopy = made(make, random_lcp(rng, 6), rng)
        y, lam = interior(rng, homotopy, span)
        system, M, rhs = bordered_at(homotopy, y, lam, rng)
        units = np.append(np.abs(y), 1.0)
        assert system.sign in (-1, 1)
        alone = system._probe[0].solve(rhs[:-1], rhs[-1])
        assert np.array_equal(system.approximate(rhs[:-1], rhs[-1]), alone)
        z, exact = np.zeros(y.size + 1), system.solve(rhs[:-1], rhs[-1])
        for _ in range(4):
            before = np.abs((z - exact) / units).max()
            r = rhs - M @ z
            z = z + system.approximate(r[:-1], r[-1])
            after = np.abs((z - exact) / units).max()
            assert after <= max(1e-2 * before, 1e-9 * np.abs(exact / units).max())


@every
def test_components_that_are_zero(make):
    """On the boundary, where the end of a path lies, the reduction divides by nothing that is zero."""
    rng = np.random.default_rng(3)
    homotopy = made(make, random_lcp(rng, 3), rng)
    y, lam = interior(rng, homotopy, 0.5)
    y[[0, 4]] = 0.0
    system, M, rhs = bordered_at(homotopy, y, lam, rng)
    assert np.allclose(system.solve(rhs[:-1], rhs[-1]), np.linalg.solve(M, rhs), rtol=1e-11)
    assert system.sign == np.linalg.slogdet(M)[0]


@every
def test_factorisation_outlives_a_change_of_its_point(make):
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


def test_without_refinement_the_quick_core_answers_alone():
    rng = np.random.default_rng(1)
    problem = random_lcp(rng, 5, "symmetric psd")
    structure, start = lcp.Structure(problem), lcp.default_start(problem)
    for name in ("kkt", "yu"):
        refined, alone = (HOMOTOPIES[name].at(problem, start, structure, refine) for refine in (True, False))
        y, lam = interior(rng, refined, 0.5)
        border, rhs = rng.standard_normal((2, y.size + 1))
        system = refined.bordered(y, lam, border)
        z = alone.bordered(y, lam, border).solve(rhs[:-1], rhs[-1])
        np.testing.assert_array_equal(z, system.quick.solve(rhs[:-1], rhs[-1]))
        np.testing.assert_allclose(z, system.solve(rhs[:-1], rhs[-1]), rtol=1e-8)


def test_w_that_is_zero():
    homotopy = lcp.KKTHomotopy(lcp.LCP([[1.0, 2.0], [0.0, 1.0]], [-3.0, 1.0]), [1.0, 1.5])
    y = np.array([1.0, 1.0, 2.0, 1.0, 1.0, 1.0])
    assert homotopy.problem.w(y[:2])[0] == 0.0
    border = np.arange(1.0, 8.0)
    M = full_matrix(homotopy, y, 0.0, border)
    system = homotopy.bordered(y, 0.0, border)
    assert np.allclose(M @ system.solve(np.ones(6), 2.0), [1, 1, 1, 1, 1, 1, 2], rtol=1e-13)
    assert system.sign == np.linalg.slogdet(M)[0]


def test_singular_matrix_is_said_to_be_singular():
    homotopy = lcp.WangHomotopy(lcp.LCP([[1.0]], [1.0]))
    with pytest.raises(ArithmeticError, match=r"singular|not finite"):
        homotopy.bordered(np.zeros(2), 0.0, np.array([1.0, 0.0, 0.0])).solve(np.ones(2), 1.0)


@given(A=matrices("PSD", n=st.integers(1, 4)), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_psd_matrix_gives_cholesky(A, seed):
    """G is positive definite wherever x, z1, z2, w > 0, whatever the rank of A."""
    rng = np.random.default_rng(seed)
    homotopy = made(lcp.KKTHomotopy, lcp.LCP(A, np.ones(len(A))), rng)
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


@pytest.mark.parametrize("make", [lcp.YuHomotopy, lcp.WangHomotopy, lcp.KojimaMegiddoMizunoHomotopy, lcp.XuHomotopy])
def test_symmetric_psd_matrix_gives_cholesky(make):
    rng = np.random.default_rng(0)
    homotopy = made(make, random_lcp(rng, 6, "symmetric psd"), rng)
    y, lam = interior(rng, homotopy, 0.5)
    assert isinstance(homotopy.bordered(y, lam, np.ones(13)).quick.core.factor, Cholesky)
    nonsymmetric = made(make, random_lcp(rng, 6, "psd"), rng)
    assert nonsymmetric.bordered(y, lam, np.ones(13)).quick is None


def test_what_is_taken_for_semidefinite():
    for A in ([[1.0, 5.0], [-5.0, 0.0]], [[1.0, -1.0], [-1.0, 1.0]], [[1e-8, 0.0], [0.0, 1e8]]):
        assert lcp.Structure(lcp.LCP(A, [0, 0])).semidefinite
    for A in ([[1.0, 2.0], [1.0, 1.0]], [[0.0, 1e-6], [0.0, 0.0]]):
        assert not lcp.Structure(lcp.LCP(A, [0, 0])).semidefinite
    for top, expected in (([2.0, -1.0], True), ([1.0, -2.0], False)):
        assert lcp.Structure(lcp.LCP(sp.csr_array(np.array([top, [-1.0, 2.0]])), [0, 0])).semidefinite is expected


@pytest.mark.parametrize("power", [-1000, -100, 0, 100, 1000])
def test_a_common_factor_makes_no_game_semidefinite(power):
    skew, game = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([[0.0, 0.7], [0.3, 0.0]])
    assert lcp.Structure(lcp.LCP(2.0**power * skew, [0, 0])).semidefinite
    assert not lcp.Structure(lcp.LCP(2.0**power * game, [0, 0])).semidefinite


def sparse_examples(rng):
    n = 40
    band = sp.diags_array([rng.standard_normal(n - abs(k)) for k in (-2, 0, 1)], offsets=[-2, 0, 1])
    scattered = sp.random_array((n, n), density=0.08, rng=rng) + sp.diags_array(rng.standard_normal(n))
    arrow = sp.lil_array((n, n))
    arrow.setdiag(rng.standard_normal(n))
    arrow[0, :] = rng.standard_normal(n)
    return {"banded": sp.csr_array(band), "scattered": sp.csr_array(scattered), "full row": sp.csr_array(arrow)}


@every
@pytest.mark.parametrize("kind", ["banded", "scattered", "full row"])
def test_sparse_and_banded_agree_with_dense(make, kind):
    rng = np.random.default_rng(7)
    A, q = sparse_examples(rng)[kind], rng.standard_normal(40)
    sparse, dense = lcp.LCP(A, q), lcp.LCP(A.toarray(), q)
    one, other = made(make, sparse, np.random.default_rng(1)), made(make, dense, np.random.default_rng(1))
    y, lam = interior(rng, one, 0.7)
    (system, M, rhs), (reference, expected_M, _) = (
        bordered_at(h, y, lam, np.random.default_rng(2)) for h in (one, other)
    )
    assert np.allclose(one.residual(y, lam), other.residual(y, lam), rtol=1e-12, atol=1e-12)
    assert sp.issparse(one.jacobian(y, lam)[0])
    assert np.allclose(M, expected_M, rtol=1e-14)
    expected = reference.solve(rhs[:-1], rhs[-1])
    for found, digits in ((system, 1e-10), (system.robust, 1e-9)):
        z = found.solve(rhs[:-1], rhs[-1])
        assert np.allclose(z, expected, rtol=1e-9, atol=digits * np.abs(expected).max())
        assert found.sign == reference.sign


def test_which_form_a_sparse_matrix_gets():
    rng = np.random.default_rng(7)
    forms = {name: lcp.Structure(lcp.LCP(A, np.ones(40))) for name, A in sparse_examples(rng).items()}
    assert isinstance(forms["banded"].scaled(1.0, np.ones(40), np.ones(40)), Banded)
    assert isinstance(forms["banded"].normal(1.0, np.ones(40), np.ones(40)), Banded)
    assert forms["scattered"].band is None
    assert forms["scattered"].squarable
    assert not forms["full row"].squarable


@pytest.mark.parametrize("make", [lcp.KKTHomotopy, lcp.WangHomotopy])
def test_tridiagonal_problem_costs_no_dense_array(make):
    n = 100_000
    off = np.full(n - 1, -1.0)
    problem = lcp.LCP(sp.diags_array([off, np.full(n, 2.0), off], offsets=[-1, 0, 1]), np.sin(np.arange(n)) - 0.3)
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
