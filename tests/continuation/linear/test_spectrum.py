"""The rightmost eigenvalues of a matrix, whatever its structure, and how many are unstable."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation.linear import Banded, Symmetric
from continuation.linear.spectrum import bounds, spectrum


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("side", [1, -1])
def test_the_inertia_of_a_symmetric_matrix_is_that_of_its_eigenvalues(seed, side):
    generator = np.random.default_rng(seed)
    A = generator.standard_normal((12, 12))
    A = A + A.T + np.diag(generator.integers(-3, 4, 12))
    found = spectrum(Symmetric(A), side)
    assert found.unstable == np.count_nonzero(side * np.linalg.eigvalsh(A) > 0.0)
    assert found.pairs.size == 0


def test_zero_eigenvalues_of_a_symmetric_matrix_count_on_neither_side():
    A = np.diag([1.0, 0.0, -2.0, 0.0, 3.0])
    assert [spectrum(Symmetric(A), side).unstable for side in (1, -1)] == [2, 1]


@pytest.mark.parametrize("kind", ["dense", "sparse", "banded"])
def test_the_rightmost_of_a_large_matrix_are_found_whatever_its_structure(kind):
    n = 150
    below, above = np.linspace(1.0, 2.0, n - 1), -np.linspace(2.0, 1.0, n - 1)
    dense = np.diag(np.linspace(0.3, -40.0, n)) + np.diag(below, -1) + np.diag(above, 1)
    banded = np.zeros((3, n))
    banded[0, 1:], banded[1], banded[2, :-1] = above, dense.diagonal(), below
    matrix = {"dense": dense, "sparse": sp.csc_array(dense), "banded": Banded(banded, 1, 1)}[kind]
    exact = np.linalg.eigvals(dense)
    found = spectrum(matrix, 1, 10)
    assert found.unstable == np.count_nonzero(exact.real > 0.0)
    assert found.rightmost == pytest.approx(exact.real.max(), rel=1e-3)


def test_the_bounds_hold_all_eigenvalues():
    generator = np.random.default_rng(3)
    for _ in range(20):
        A = generator.standard_normal((8, 8)) * 10.0 ** generator.uniform(-2, 2, (8, 1))
        real, imaginary = bounds(A)
        values = np.linalg.eigvals(A)
        assert values.real.max() <= real
        assert np.abs(values.imag).max() <= imaginary


def test_eigenvalues_that_may_have_been_overlooked_are_said():
    # A pair far up the axis is farther from every real shift than the many that are near to it.
    A = sp.block_diag([sp.csc_array([[0.1, -50.0], [50.0, 0.1]]), sp.diags_array(np.linspace(-3.0, -0.1, 200))], "csc")
    found = spectrum(A)
    assert not found.covered
    assert found.unstable == 0
    whole = spectrum(A, k=202)
    assert whole.covered
    assert whole.unstable == 2


def test_more_are_computed_where_all_that_were_asked_for_are_unstable():
    A = sp.diags_array(np.concatenate([np.linspace(1.0, 2.0, 20), np.linspace(-9.0, -1.0, 200)]), format="csc")
    found = spectrum(A)
    assert found.unstable == 20
    assert found.covered


@pytest.mark.parametrize("make", [np.asarray, sp.csc_array])
def test_an_eigenvalue_of_many_unknowns_does_not_hide_the_pairs_of_a_few(make):
    """Unknowns that decay alike, coupled by four vectors: one eigenvalue 146 times, and two pairs."""
    U = np.linalg.qr(np.random.default_rng(0).standard_normal((150, 4)))[0]
    turn = np.zeros((4, 4))
    turn[[0, 1, 2, 3], [1, 0, 3, 2]] = [3.0, -3.0, 1.0, -1.0]
    A = U @ turn @ U.T - np.eye(150)
    found = [spectrum(make(A)) for _ in range(2)]
    np.testing.assert_array_equal(found[0].values, found[1].values)
    np.testing.assert_allclose(sorted(found[0].pairs.imag), [1.0, 3.0], rtol=1e-6)


def test_an_operator_has_no_eigenvalues_that_are_known():
    with pytest.raises(TypeError, match="stability: expected H_y as a matrix, found MatrixLinearOperator"):
        spectrum(sp.linalg.aslinearoperator(np.eye(3)))
