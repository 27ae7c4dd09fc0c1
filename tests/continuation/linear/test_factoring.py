"""The door to sparse factorisations: what is chosen, by a method of the test's own; the extras where they are there."""

import numpy as np
import pytest
import scipy.sparse as sp
from attrs import evolve, field, frozen
from scipy.sparse.linalg import LinearOperator

from continuation.linear import factor_bordered
from continuation.linear.extras import EXTRAS, Multigrid
from continuation.linear.factoring import Factoring, check_method
from continuation.linear.look import Look
from continuation.linear.superlu import SparseFactor, SuperLUMethod
from continuation.linear.symmetric import factor_cholesky

BY_NAME = {one.name: one for one in EXTRAS}


@frozen
class DenseMethod:
    """Cholesky's method on the whole square."""

    name: str = "dense"
    needs: str = "numpy"
    signed: bool = True
    least: float = 10
    fails: bool = False
    tried: list = field(factory=list)

    def suits(self, look):
        return look.definite_perhaps

    def factor(self, look):
        self.tried.append(self.name)
        factor = None if self.fails else factor_cholesky(np.asfortranarray(look.matrix.toarray()))
        return None if factor is None else SparseFactor("dense", factor.solve, look.n**2, lambda: factor.sign)


def laplacian(m):
    """Five-point differences on m x m points."""
    T = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(m, m), dtype=float)
    return sp.csc_array(sp.kron(T, sp.eye_array(m)) + sp.kron(sp.eye_array(m), T))


def made(matrix, *extras, **options):
    """Who factors a matrix, and what is said of it; the solution is checked."""
    factoring = Factoring(extras=extras, **options)
    matrix = sp.csc_array(matrix)
    factor = factoring.factor(matrix)
    b = np.linspace(1.0, 2.0, matrix.shape[0])
    assert np.abs(matrix @ factor.solve(b) - b).max() < 1e-10
    return factor.name, str(factoring)


def test_a_method_is_chosen_that_suits_and_is_installed():
    A = laplacian(5)
    assert made(A, DenseMethod()) == ("dense", "Sparse factorisations: 1 by dense, at most 6.2e+02 numbers.")
    lopsided = A + sp.csc_array(([0.5], ([0], [7])), shape=A.shape)
    assert made(lopsided, DenseMethod())[0] == "SuperLU"
    assert made(laplacian(3), DenseMethod())[0] == "SuperLU"
    assert made(A, DenseMethod(needs="no_such_package"))[0] == "SuperLU"
    assert made(A)[0] == "SuperLU"
    assert str(Factoring()) == ""


def test_of_two_methods_the_first_is_taken_and_one_asked_for_before_it():
    first, second = DenseMethod(name="first", least=20, signed=False), DenseMethod(name="second", fails=True)
    tried = []

    def who(m, **options):
        tried.clear()
        made(laplacian(m), evolve(second, tried=tried), evolve(first, tried=tried), **options)
        return tried

    assert who(5) == ["second", "first"]
    assert who(4) == ["second"]
    assert who(5, signed=True) == ["second"]
    assert who(3, method="first") == ["first"]
    assert who(5, method="superlu") == []


@pytest.mark.parametrize("m", [5, 6])
def test_a_negative_definite_matrix_is_factored_with_its_sign_changed(m):
    A = -laplacian(m)
    assert made(A, DenseMethod())[0] == "dense"
    assert Factoring(extras=(DenseMethod(),)).factor(sp.csc_array(A)).sign == (-1) ** m


def test_what_a_method_cannot_do_is_left_to_superlu():
    indefinite = laplacian(5) - 1.5 * sp.eye_array(25)
    assert (indefinite.diagonal() > 0.0).all()
    name, said = made(indefinite, DenseMethod())
    assert name == "SuperLU"
    assert said.startswith("Sparse factorisations: 1 by SuperLU, at most ")
    assert Factoring(extras=(DenseMethod(),)).factor(sp.csc_array(np.ones((12, 12)))) is None


def test_a_look_at_a_matrix():
    A = laplacian(6)
    look = Look(A)
    assert look.symmetric_pattern
    assert look.definite_perhaps
    assert look.diffusion
    assert look.dominant
    units = sp.diags_array(10.0 ** np.linspace(-6, 6, 36))
    rounded = sp.csc_array(units @ (A * (1.0 / 3.0)) @ units)
    rounded.data *= 1.0 + 1e-16 * np.random.default_rng(1).integers(-3, 4, rounded.nnz)
    assert Look(rounded).definite_perhaps
    skew = A + sp.csc_array(([1e-9, -1e-9], ([0, 1], [1, 0])), shape=A.shape)
    assert Look(sp.csc_array(skew)).symmetric_pattern
    assert not Look(sp.csc_array(skew)).definite_perhaps
    assert not Look(sp.csc_array(abs(A))).diffusion
    assert not Look(sp.csc_array(A - 0.01 * sp.eye_array(36))).dominant
    assert not Look(sp.csc_array(-A)).definite_perhaps


def test_a_method_is_asked_for_by_a_name_and_must_be_installed(monkeypatch):
    assert check_method("sparse", "auto") == "auto"
    assert check_method("sparse", "superlu") == "superlu"
    with pytest.raises(ValueError, match=r"^sparse: expected one of auto, superlu, .*, found 'umfpack'$"):
        check_method("sparse", "umfpack")
    with pytest.raises(ValueError, match="found int"):
        check_method("sparse", 3)
    monkeypatch.setattr("continuation.linear.factoring.find_spec", lambda name: None)
    for name, one in BY_NAME.items():
        with pytest.raises(ImportError, match=f"sparse='{name}' needs {one.needs}: pip install 'pseudoarclength"):
            check_method("sparse", name)


@pytest.mark.parametrize("name", BY_NAME)
def test_an_extra_solves_to_round_off(name):
    method = BY_NAME[name]
    pytest.importorskip(method.needs)
    A = laplacian(40)
    look = Look(A)
    assert method.suits(look)
    factor = method.factor(look)
    x = np.random.default_rng(0).normal(size=1600)
    b = A @ x
    assert np.abs(A @ factor.solve(b) - b).max() <= 1e-14 * np.abs(x).max()
    np.testing.assert_array_equal(b, A @ x)
    assert factor.sign == 1
    assert factor.fill >= 0
    assert made(A, method, method=name)[0] == factor.name
    assert made(A - 1.5 * sp.eye_array(1600), method, method=name)[0] in ("SuperLU", "multigrid")


class Levels:
    """A hierarchy that does nothing."""

    def __init__(self, n):
        self.n = n

    def aspreconditioner(self, cycle):
        return LinearOperator((self.n, self.n), matvec=lambda r: r)


@pytest.mark.parametrize(("m", "direct"), [(10, False), (60, True)])
def test_conjugate_gradients_end_at_round_off_or_give_up(m, direct):
    A = laplacian(m)
    factor = Multigrid(Look(A), Levels(m * m))
    b = np.linspace(1.0, 2.0, m * m)
    x = factor.solve(b)
    assert np.abs(A @ x - b).max() <= 1e-13 * np.abs(x).max()
    assert ("_direct" in factor.__dict__) is direct


def test_a_homotopy_uses_what_suits_its_jacobian(monkeypatch):
    """The bordered system is the same by any method; behind a fold Cholesky's fails and SuperLU takes over."""
    used = []
    real = Factoring.factor

    def spied(self, matrix):
        self.extras = (DenseMethod(),)
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
