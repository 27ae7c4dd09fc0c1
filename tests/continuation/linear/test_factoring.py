"""The door to sparse factorisations: what is chosen, with a Cholesky of the test's own; packages that are there."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from continuation.linear import factor_bordered
from continuation.linear.factoring import Factoring, check_method
from continuation.linear.symmetric import factor_cholesky

FACTORING = "continuation.linear.factoring."


@pytest.fixture
def dense(monkeypatch):
    """Cholesky's method on the whole square in place of CHOLMOD, from order 10 on."""

    def factor(matrix):
        return getattr(factor_cholesky(np.asfortranarray(matrix.toarray())), "solve", None)

    for name, value in (
        ("factor_cholmod", factor),
        ("PACKAGES", {"cholmod": ("cvxopt", 10)}),
        ("find_spec", lambda name: name),
    ):
        monkeypatch.setattr(FACTORING + name, value)


def laplacian(m, shift=0.0):
    """Five-point differences on m x m points."""
    T = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(m, m), dtype=float)
    return sp.csc_array(sp.kron(T, sp.eye_array(m)) + sp.kron(sp.eye_array(m), T) - shift * sp.eye_array(m * m))


UNITS = sp.diags_array(10.0 ** np.linspace(-1, 1, 25))
ROUNDED = sp.csc_array(UNITS @ (laplacian(5) * (1.0 / 3.0)) @ UNITS)
ROUNDED.data *= 1.0 + 1e-16 * np.random.default_rng(1).integers(-3, 4, ROUNDED.nnz)
SKEW = laplacian(5) + sp.csc_array(([1e-9, -1e-9], ([0, 1], [1, 0])), shape=(25, 25))
LOPSIDED = laplacian(5) + sp.csc_array(([0.5], ([0], [7])), shape=(25, 25))


@pytest.mark.parametrize(
    ("matrix", "options", "name"),
    [
        (laplacian(5), {}, "CHOLMOD"),
        (laplacian(5), {"method": "superlu"}, "SuperLU"),
        (laplacian(3), {}, "SuperLU"),
        (laplacian(3), {"method": "cholmod"}, "CHOLMOD"),
        (LOPSIDED, {}, "SuperLU"),
        (SKEW, {}, "SuperLU"),
        (ROUNDED, {}, "CHOLMOD"),
        # A negative definite one is factored with its sign changed.
        (-laplacian(5), {}, "CHOLMOD"),
        (-laplacian(6), {}, "CHOLMOD"),
        (laplacian(5, 1.5), {}, "SuperLU"),
    ],
    ids=[
        "suits", "asked for", "small", "small, asked for", "lopsided", "skew", "rounded", "negative", "negative, even",
        "indefinite",
    ],
)  # fmt: skip
def test_what_suits_is_chosen_if_it_is_installed(dense, monkeypatch, matrix, options, name):
    factoring = Factoring(**options)
    factor, b = factoring.factor(sp.csc_array(matrix)), np.linspace(1.0, 2.0, matrix.shape[0])
    assert np.abs(matrix @ factor.solve(b) - b).max() < 1e-10
    assert factor.sign == np.linalg.slogdet(matrix.toarray())[0]
    assert str(factoring) == f"Sparse factorisations: 1 by {name}."
    monkeypatch.setattr(FACTORING + "find_spec", lambda name: None)
    assert options or method(Factoring(), matrix) == "SuperLU"


def test_what_is_singular_has_no_factors(dense):
    assert (Factoring().factor(sp.csc_array(np.ones((12, 12)))), str(Factoring())) == (None, "")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("umfpack", r"^sparse: expected one of auto, superlu, pardiso, cholmod, found 'umfpack'$"),
        (3, "found int"),
        ("cholmod", "sparse='cholmod' needs cvxopt: pip install 'pseudoarclength"),
        ("pardiso", "sparse='pardiso' needs pypardiso: pip install 'pseudoarclength"),
    ],
)
def test_a_method_is_asked_for_by_a_name_and_must_be_installed(monkeypatch, name, words):
    monkeypatch.setattr(FACTORING + "find_spec", lambda name: None)
    assert check_method("sparse", "superlu") == "superlu"
    with pytest.raises((ValueError, ImportError), match=words):
        check_method("sparse", name)


def method(factoring, matrix):
    """What factors the matrix."""
    factoring.factor(sp.csc_array(matrix))
    return [*factoring.used][-1]


@pytest.mark.parametrize(
    ("name", "package", "indefinite"), [("cholmod", "cvxopt", "SuperLU"), ("pardiso", "pypardiso", "PARDISO")]
)
def test_packages_solve_to_round_off(name, package, indefinite):
    """Their factors live as long as what solves with them."""
    pytest.importorskip(package)
    A, shifted, x = laplacian(40), laplacian(40, 1.5), np.random.default_rng(0).normal(size=1600)
    solve, b = Factoring(name).factor(A).solve, A @ x
    assert np.abs(A @ solve(b) - b).max() <= 1e-14 * np.abs(x).max()
    np.testing.assert_array_equal(b, A @ x)
    assert [method(Factoring(name), matrix) for matrix in (A, shifted)] == [name.upper(), indefinite]
    assert [Factoring(name).factor(M).sign for M in (A, shifted)] == [
        1,
        np.linalg.slogdet(shifted.toarray())[0],
    ]
    assert Factoring(name).factor(sp.csc_array(sp.kron(sp.eye_array(20), np.ones((2, 2))))) is None
    assert name == "cholmod" or solve.func.__self__.factorized_A.nnz


@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_a_bordered_system_is_the_same_by_any_method(dense, shift):
    """Behind a fold Cholesky's fails and SuperLU takes over."""
    rng, A = np.random.default_rng(3), laplacian(6, shift)
    column, row, r = rng.normal(size=36), rng.normal(size=37), rng.normal(size=36)
    system = factor_bordered(A, column, row)
    whole = np.block([[A.toarray(), column[:, None]], [row[None]]])
    np.testing.assert_allclose(whole @ system.solve(r, 1.0), np.append(r, 1.0), atol=1e-12)
    assert system.sign == np.sign(np.linalg.det(whole))


@pytest.mark.parametrize("weak_pivots", [True, False])
def test_superlu_exchanges_rows_where_it_is_asked_to_and_fills_a_perforated_grid_little(monkeypatch, weak_pivots):
    found = []
    monkeypatch.setattr(FACTORING + "factor_superlu", lambda A, **how: found.append(splu(A, **how)) or found[-1])
    weak = sp.csc_array(np.array([[1e-2, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 5.0]]))
    assert Factoring(weak_pivots=weak_pivots).factor(weak).sign == np.sign(np.linalg.det(weak.toarray()))
    assert (found[0].perm_r == found[0].perm_c).all() == weak_pivots
    inside = np.random.default_rng(0).random(3600) < 0.9
    Factoring("superlu", weak_pivots).factor(laplacian(60)[inside][:, inside])
    assert found[1].nnz < 40 * inside.sum()
