"""Bordered systems where H_y is singular, as at the folds of discrete boundary value problems."""

import numpy as np
import pytest
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse import csc_array, diags_array, eye_array, kron
from scipy.sparse.linalg import aslinearoperator

from continuation.linear import SingularError, factor_bordered

from ...util import tridiagonal


def at_fold(dimensions, n):
    """(H_y, H_lam, null vector): second differences less their eigenvalue nearest to zero, as at a fold of Bratu's."""
    second = diags_array([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]) * (n + 1.0) ** 2
    sine, value = np.sin(np.pi * np.arange(1, n + 1) / (n + 1)), 4.0 * ((n + 1) * np.sin(0.5 * np.pi / (n + 1))) ** 2
    if dimensions == 2:
        second, sine, value = kron(second, eye_array(n)) + kron(eye_array(n), second), np.kron(sine, sine), 2.0 * value
    return csc_array(second + value * eye_array(sine.size)), np.exp(sine), sine / np.linalg.norm(sine)


def bordered_at(dimensions, n, shift):
    """(H_y, H_lam, border, right-hand side) so far from the fold, and the whole matrix."""
    matrix, column, phi = at_fold(dimensions, n)
    matrix, row = csc_array(matrix + shift * eye_array(phi.size)), np.append(phi, 0.1)
    rhs = np.append(np.sin(np.arange(phi.size)), 1.0)
    return matrix, column, row, rhs, np.block([[matrix.toarray(), column[:, None]], [row[None, :]]])


def in_long_double(matrix, rhs):
    """A precision at which a fold is harmless, by refinement."""
    factors, wide = lu_factor(matrix), matrix.astype(np.longdouble)
    z = np.zeros(len(rhs), dtype=np.longdouble)
    for _ in range(6):
        z = z + lu_solve(factors, (rhs - wide @ z).astype(float))
    return z.astype(float)


SHIFTS = [0.0] + [sign * size for size in (1e-15, 1e-12, 1e-9, 1e-6, 1e-3) for sign in (-1, 1)]


@pytest.mark.parametrize("shift", SHIFTS)
@pytest.mark.parametrize(
    ("dimensions", "n", "structures", "digits"),
    # In one dimension the condition of M is 3e6, of which a backward stable solver may lose 6e-10.
    [(1, 1000, (tridiagonal, csc_array), 2e-11), (2, 20, (csc_array, aslinearoperator), 5e-13)],
)
def test_bordered_systems_are_solved_at_and_near_a_fold(dimensions, n, structures, digits, shift):
    matrix, column, row, rhs, whole = bordered_at(dimensions, n, shift)
    truth = in_long_double(whole, rhs)
    for structure in structures:
        factored = factor_bordered(structure(matrix), column, row)
        z = factored.solve(rhs[:-1], rhs[-1])
        assert np.abs(z - truth).max() <= digits * np.abs(truth).max()
        assert factored.sign in ({0} if structure is aslinearoperator else {np.linalg.slogdet(whole)[0]})


def test_an_operator_without_a_preconditioner_that_does_not_converge_is_said():
    matrix, column, row, rhs, _ = bordered_at(1, 1000, 0.0)
    with pytest.raises(SingularError, match=r"did not converge.*preconditioner"):
        factor_bordered(aslinearoperator(matrix), column, row).solve(rhs[:-1], rhs[-1])
