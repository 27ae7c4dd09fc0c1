"""The door to sparse factorisations: what is chosen, with a Cholesky of the test's own; CHOLMOD where it is there."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation.linear import factor_bordered
from continuation.linear.factoring import Factoring, check_method, factor_definite
from continuation.linear.look import Look
from continuation.linear.superlu import SparseFactor, SuperLUMethod
from continuation.linear.symmetric import factor_cholesky


@pytest.fixture
def dense(monkeypatch):
    """Cholesky's method on the whole square in place of CHOLMOD, from order 10 on."""

    def factor(matrix):
        factor = factor_cholesky(np.asfortranarray(matrix.toarray()))
        return (
            None if factor is None else SparseFactor("dense", factor.solve, matrix.shape[0] ** 2, lambda: factor.sign)
        )

    module = "continuation.linear.factoring."
    for name, value in (("factor_cholmod", factor), ("CHOLMOD_FROM", 10), ("find_spec", lambda name: name)):
        monkeypatch.setattr(module + name, value)


def laplacian(m):
    """Five-point differences on m x m points."""
    T = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(m, m), dtype=float)
    return sp.csc_array(sp.kron(T, sp.eye_array(m)) + sp.kron(sp.eye_array(m), T))


def made(matrix, **options):
    """Who factors a matrix, and what is said of it; the solution is checked."""
    factoring = Factoring(**options)
    matrix = sp.csc_array(matrix)
    factor = factoring.factor(matrix)
    b = np.linspace(1.0, 2.0, matrix.shape[0])
    assert np.abs(matrix @ factor.solve(b) - b).max() < 1e-10
    return factor.name, str(factoring)


def test_what_suits_is_chosen_if_it_is_installed(dense, monkeypatch):
    A = laplacian(5)
    assert made(A) == ("dense", "Sparse factorisations: 1 by dense, at most 6.2e+02 numbers.")
    lopsided = A + sp.csc_array(([0.5], ([0], [7])), shape=A.shape)
    assert made(lopsided)[0] == "SuperLU"
    assert made(laplacian(3))[0] == made(A, method="superlu")[0] == "SuperLU"
    assert made(laplacian(3), method="cholmod")[0] == "dense"
    monkeypatch.setattr("continuation.linear.factoring.find_spec", lambda name: None)
    assert made(A)[0] == "SuperLU"
    assert str(Factoring()) == ""


@pytest.mark.parametrize("m", [5, 6])
def test_a_negative_definite_matrix_is_factored_with_its_sign_changed(dense, m):
    A = -laplacian(m)
    assert made(A)[0] == "dense"
    assert Factoring().factor(sp.csc_array(A)).sign == (-1) ** m


def test_what_is_not_definite_is_left_to_superlu(dense):
    indefinite = laplacian(5) - 1.5 * sp.eye_array(25)
    assert (indefinite.diagonal() > 0.0).all()
    name, said = made(indefinite)
    assert name == "SuperLU"
    assert said.startswith("Sparse factorisations: 1 by SuperLU, at most ")
    assert Factoring().factor(sp.csc_array(np.ones((12, 12)))) is None


def test_a_look_at_a_matrix():
    A = laplacian(6)
    look = Look(A)
    assert look.symmetric_pattern
    assert look.definite_perhaps
    units = sp.diags_array(10.0 ** np.linspace(-6, 6, 36))
    rounded = sp.csc_array(units @ (A * (1.0 / 3.0)) @ units)
    rounded.data *= 1.0 + 1e-16 * np.random.default_rng(1).integers(-3, 4, rounded.nnz)
    assert Look(rounded).definite_perhaps
    skew = A + sp.csc_array(([1e-9, -1e-9], ([0, 1], [1, 0])), shape=A.shape)
    assert Look(sp.csc_array(skew)).symmetric_pattern
    assert not Look(sp.csc_array(skew)).definite_perhaps
    assert not Look(sp.csc_array(-A)).definite_perhaps


def test_a_method_is_asked_for_by_a_name_and_must_be_installed(monkeypatch):
    assert check_method("sparse", "auto") == "auto"
    assert check_method("sparse", "superlu") == "superlu"
    with pytest.raises(ValueError, match=r"^sparse: expected one of auto, superlu, cholmod, found 'umfpack'$"):
        check_method("sparse", "umfpack")
    with pytest.raises(ValueError, match="found int"):
        check_method("sparse", 3)
    monkeypatch.setattr("continuation.linear.factoring.find_spec", lambda name: None)
    with pytest.raises(ImportError, match="sparse='cholmod' needs cvxopt: pip install 'pseudoarclength"):
        check_method("sparse", "cholmod")


def test_cholmod_solves_to_round_off():
    pytest.importorskip("cvxopt")
    A = laplacian(40)
    factor = factor_definite(Look(A))
    x = np.random.default_rng(0).normal(size=1600)
    b = A @ x
    assert np.abs(A @ factor.solve(b) - b).max() <= 1e-14 * np.abs(x).max()
    np.testing.assert_array_equal(b, A @ x)
    assert factor.sign == 1
    assert made(A, method="cholmod")[0] == made(A)[0] == factor.name == "CHOLMOD"
    assert made(A - 1.5 * sp.eye_array(1600), method="cholmod")[0] == "SuperLU"


def test_a_homotopy_uses_what_suits_its_jacobian(dense, monkeypatch):
    """The bordered system is the same by any method; behind a fold Cholesky's fails and SuperLU takes over."""
    used = []
    real = Factoring.factor

    def spied(self, matrix):
        factor = real(self, matrix)
        used.append(None if factor is None else factor.name)
        return factor

    monkeypatch.setattr(Factoring, "factor", spied)
    rng = np.random.default_rng(3)
    for shift, name in ((0.0, "dense"), (0.5, "SuperLU")):
        A = laplacian(6) - shift * sp.eye_array(36)
        column, row, r = rng.normal(size=36), rng.normal(size=37), rng.normal(size=36)
        system = factor_bordered(sp.csc_array(A), column, row)
        whole = np.block([[A.toarray(), column[:, None]], [row[None]]])
        np.testing.assert_allclose(whole @ system.solve(r, 1.0), np.append(r, 1.0), atol=1e-12)
        assert system.sign == np.sign(np.linalg.det(whole))
        assert used.pop() == name


def test_superlu_exchanges_rows_where_it_is_asked_to():
    weak = sp.csc_array(np.array([[1e-2, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 5.0]]))
    kept, exchanged = (SuperLUMethod(weak_pivots=weak_pivots).factor(Look(weak)) for weak_pivots in (True, False))
    assert kept.sign == exchanged.sign == np.sign(np.linalg.det(weak.toarray()))
    assert kept.fill > 0
