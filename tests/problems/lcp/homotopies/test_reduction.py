"""The reduction of a bordered system to its core: accuracy, structure, and what is singular."""

import tracemalloc

import mpmath
import numpy as np
import pytest
import scipy.sparse as sp

from problems import lcp

from .util import bordered_at, every, interior, made, random_lcp


def exact_solution(M, rhs):
    """The solution, its sensitivity to relative changes of the entries by one unit, and the determinant's sign."""
    with mpmath.workdps(90):
        matrix = mpmath.matrix(M.tolist())
        inverse = matrix**-1
        solution = np.array([float(e) for e in inverse * mpmath.matrix(rhs.tolist())])
        sizes = np.abs([[float(e) for e in row] for row in inverse.tolist()])
        return solution, sizes @ (np.abs(M) @ np.abs(solution) + np.abs(rhs)), int(mpmath.sign(mpmath.det(matrix)))


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
def test_components_that_are_zero_and_a_point_that_moves_on(make):
    """On the boundary, where the end of a path lies, the reduction divides by nothing that is zero."""
    rng = np.random.default_rng(3)
    homotopy = made(make, random_lcp(rng, 3), rng)
    y, lam = interior(rng, homotopy, 0.5)
    y[[0, 4]] = 0.0
    system, M, rhs = bordered_at(homotopy, y, lam, rng)
    rhs[-1] = 1.0  # as for the tangent, whose other entries are zero
    y += 1.0
    np.testing.assert_allclose(system.solve(rhs[:-1], rhs[-1]), np.linalg.solve(M, rhs), rtol=1e-11, atol=1e-14)
    assert system.sign == np.linalg.slogdet(M)[0]


def test_a_core_in_which_one_row_drowns_the_others_is_not_used():
    homotopy = lcp.KKTHomotopy(lcp.LCP([[1.0, -2.0, 0.5], [0, 0, 0], [0, 0, 0]], np.ones(3)), np.ones(3), w0=np.ones(3))
    system, M, rhs = bordered_at(
        homotopy, np.array([1.0, 1.0, 1.0, 1e3, 1e-4, 1e-9, 1e13, 1.0, 1e-4]), 1e-7, np.random.default_rng(0)
    )
    solution, _, sign = exact_solution(M, rhs)
    np.testing.assert_allclose(system.solve(rhs[:-1], rhs[-1]), solution, rtol=1e-6)
    assert system.sign == sign


def test_singular_matrix_is_said_to_be_singular():
    homotopy = lcp.WangHomotopy(lcp.LCP([[1.0]], [1.0]))
    with pytest.raises(ArithmeticError, match=r"singular|not finite"):
        homotopy.bordered(np.zeros(2), 0.0, np.array([1.0, 0.0, 0.0])).solve(np.ones(2), 1.0)


@pytest.mark.parametrize(
    ("A", "expected"),
    [
        ([[1.0, 5.0], [-5.0, 0.0]], True), ([[1.0, -1.0], [-1.0, 1.0]], True), ([[1e-8, 0.0], [0.0, 1e8]], True),
        ([[1.0, 2.0], [1.0, 1.0]], False), ([[0.0, 1e-6], [0.0, 0.0]], False), ([[0.0, 0.7], [0.3, 0.0]], False),
        (sp.csr_array([[2.0, -1.0], [-1.0, 2.0]]), True), (sp.csr_array([[1.0, -2.0], [-1.0, 2.0]]), False),
    ],
)  # fmt: skip
@pytest.mark.parametrize("power", [-1000, -100, 0, 100, 996])
def test_what_is_taken_for_semidefinite_in_any_unit(A, expected, power):
    A = 2.0**power * (A if sp.issparse(A) else np.array(A))
    assert lcp.Structure(lcp.LCP(A, [0, 0])).semidefinite is expected


@pytest.mark.parametrize("make", [lcp.KKTHomotopy, lcp.WangHomotopy])
def test_tridiagonal_problem_costs_no_dense_array(make):
    n = 100_000
    A = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n))
    homotopy = make(lcp.LCP(A, np.sin(np.arange(n)) - 0.3))
    rng = np.random.default_rng(0)
    y = homotopy.start()[0]
    y *= rng.uniform(0.8, 1.2, y.size)
    border, rhs = rng.standard_normal((2, y.size + 1))
    tracemalloc.start()
    z = homotopy.bordered(y, 0.9, border).solve(rhs[:-1], rhs[-1])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 400e6, "a few dozen vectors, where a dense matrix takes 8e10 bytes"
    assert np.abs(homotopy.differential(y, 0.9, z) - rhs[:-1]).max() < 1e-9 * np.abs(z).max()
