"""The rightmost eigenvalues of a matrix, whatever its structure, and how many are unstable."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp

from continuation.linear.spectrum import spectrum

from ...util import tridiagonal

# Unknowns that decay alike, coupled by four vectors: one eigenvalue 146 times, and two pairs, which it does not hide.
TURN = la.block_diag([[0.0, 3.0], [-3.0, 0.0]], [[0.0, 1.0], [-1.0, 0.0]])
U = np.linalg.qr(np.random.default_rng(0).standard_normal((150, 4)))[0]
ALIKE = U @ TURN @ U.T - np.eye(150)
LONG = np.diag(np.linspace(0.3, -40.0, 150))
LONG += np.diag(np.linspace(1.0, 2.0, 149), -1) - np.diag(np.linspace(2.0, 1.0, 149), 1)
# All that are asked for are unstable, so more are computed.
TWENTY = np.diag(np.concatenate([np.linspace(1.0, 2.0, 20), np.linspace(-9.0, -1.0, 200)]))
# Swift and Hohenberg's: Gershgorin's discs end at 12,655, beyond the rightmost eigenvalue.
ONCE = np.eye(300) + (300 / 40.0) ** 2 * (np.eye(300, k=1) - 2.0 * np.eye(300) + np.eye(300, k=-1))
BENDING = [growth * np.eye(300) - ONCE @ ONCE for growth in (-0.3, 0.05, 0.14)]


@pytest.mark.parametrize(
    ("matrix", "make", "k"),
    [
        *((LONG, make, 10) for make in (np.asarray, sp.csc_array, tridiagonal)),
        *((ALIKE, make, None) for make in (np.asarray, sp.csc_array)),
        (TWENTY, sp.csc_array, None),
        *((matrix, make, None) for matrix in BENDING for make in (np.asarray, sp.csc_array)),
    ],
)
def test_the_rightmost_of_a_large_matrix_are_found_whatever_its_structure(matrix, make, k):
    exact = np.linalg.eigvals(matrix)
    found = [spectrum(make(matrix), 1, k) for _ in range(2)]
    np.testing.assert_array_equal(found[0].values, found[1].values)
    assert found[0].unstable == np.count_nonzero(exact.real > 1e-9)
    assert found[0].rightmost == pytest.approx(exact.real.max(), rel=1e-6 if len(matrix) == 300 else 1e-3, abs=1e-6)
    assert found[0].covered or len(matrix) == 150
    # The disc's shift took 300 and more, and left eigenvalues that may have been overlooked.
    assert found[0].solves < 150 or len(matrix) != 300
    if matrix is ALIKE:
        np.testing.assert_allclose(sorted(found[0].pairs.imag), [1.0, 3.0], rtol=1e-6)


@pytest.mark.parametrize(("k", "known", "unstable"), [(None, False, 0), (202, True, 2)])
def test_eigenvalues_that_may_have_been_overlooked_are_said(k, known, unstable):
    # A pair far up the axis is farther from every real shift than the many that are near to it.
    A = sp.block_diag([sp.csc_array([[0.1, -50.0], [50.0, 0.1]]), sp.diags_array(np.linspace(-3.0, -0.1, 200))], "csc")
    found = spectrum(A, k=k)
    assert (found.covered, found.unstable) == (known, unstable)


def test_an_operator_has_no_eigenvalues_that_are_known():
    with pytest.raises(TypeError, match="stability: expected H_y as a matrix, found MatrixLinearOperator"):
        spectrum(sp.linalg.aslinearoperator(np.eye(3)))
