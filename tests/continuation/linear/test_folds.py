"""Bordered systems at the folds of the discrete Bratu problem, L y + lam exp(y) = 0, where H_y is singular."""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np
import pytest
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse import block_array, csc_array, diags_array, eye_array, kron
from scipy.sparse.linalg import LinearOperator, aslinearoperator, splu, spsolve

from continuation.linear import Banded, Operator, SingularError, Symmetric, factor_bordered
from continuation.linear.elimination import BlockElimination


def laplacian(n):
    second = diags_array([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1])
    return csc_array(second * (n + 1) ** 2)


def fold(operator, y, lam, phi):
    """(H_y, H_lam, null vector) at the fold, by Newton's method on the extended system of Seydel and Moore & Spence."""
    n = len(y)
    phi = phi / np.linalg.norm(phi)
    along = phi
    for _ in range(8):
        e = np.exp(y)
        jacobian = operator + diags_array(lam * e)
        gap = np.concatenate([operator @ y + lam * e, jacobian @ phi, [along @ phi - 1]])
        extended = block_array(
            [
                [jacobian, None, e[:, None]],
                [diags_array(lam * e * phi), jacobian, (e * phi)[:, None]],
                [None, along[None, :], None],
            ],
            format="csc",
        )
        step = -spsolve(extended, gap)
        y, phi, lam = y + step[:n], phi + step[n:-1], lam + step[-1]
    return csc_array(operator + diags_array(lam * np.exp(y))), np.exp(y), phi


@cache
def fold_1d(n=1000):
    sine = np.sin(np.pi * np.arange(1, n + 1) / (n + 1))
    return fold(laplacian(n), 1.19 * sine, 3.51, sine)


@cache
def fold_2d(m=20):
    sine = np.sin(np.pi * np.arange(1, m + 1) / (m + 1))
    mode = np.kron(sine, sine)
    operator = csc_array(kron(laplacian(m), eye_array(m)) + kron(eye_array(m), laplacian(m)))
    return fold(operator, 1.39 * mode, 6.8, mode)


def tridiagonal(matrix):
    n = matrix.shape[0]
    ab = np.zeros((3, n))
    ab[0, 1:], ab[1], ab[2, :-1] = matrix.diagonal(1), matrix.diagonal(), matrix.diagonal(-1)
    return Banded(ab, 1, 1)


def in_sixty_digits(matrix, column, row, rhs):
    """The tridiagonal system, by block elimination without pivoting, at a precision at which a fold is harmless."""
    n = matrix.shape[0]
    with mpmath.workdps(60):
        below, diagonal, above = ([mpmath.mpf(x) for x in matrix.diagonal(k).tolist()] for k in (-1, 0, 1))
        for i in range(1, n):
            below[i - 1] /= diagonal[i - 1]
            diagonal[i] -= below[i - 1] * above[i - 1]

        def substitute(values):
            x = [mpmath.mpf(v) for v in values.tolist()]
            for i in range(1, n):
                x[i] -= below[i - 1] * x[i - 1]
            x[-1] /= diagonal[-1]
            for i in range(n - 2, -1, -1):
                x[i] = (x[i] - above[i] * x[i + 1]) / diagonal[i]
            return x

        x, w, c = substitute(rhs[:-1]), substitute(column), [mpmath.mpf(v) for v in row.tolist()]
        schur = c[-1] - mpmath.fdot(c[:-1], w)
        lam = (mpmath.mpf(float(rhs[-1])) - mpmath.fdot(c[:-1], x)) / schur
        negative = sum(d < 0 for d in diagonal) + (schur < 0)
        return np.array([float(a - lam * b) for a, b in zip(x, w)] + [float(lam)]), (-1) ** int(negative)


def in_long_double(matrix, rhs):
    factors = lu_factor(matrix)
    wide = matrix.astype(np.longdouble)
    z = np.zeros(len(rhs), dtype=np.longdouble)
    for _ in range(6):
        z = z + lu_solve(factors, (rhs - wide @ z).astype(float))
    return z.astype(float)


SHIFTS = [0.0] + [sign * size for size in (1e-15, 1e-12, 1e-9, 1e-6, 1e-3) for sign in (-1, 1)]


def bordered_at(fold, shift):
    """(H_y, H_lam, border, right-hand side) so far from the fold."""
    at_fold, column, phi = fold()
    n = len(phi)
    return csc_array(at_fold + shift * eye_array(n)), column, np.append(phi, 0.1), np.append(np.sin(np.arange(n)), 1.0)


def check(structures, system, truth, digits, signs):
    matrix, column, row, rhs = system
    for structure in structures:
        factored = factor_bordered(structure(matrix), column, row)
        z = factored.solve(rhs[:-1], rhs[-1])
        assert np.abs(z - truth).max() <= digits * np.abs(truth).max()
        assert factored.sign in signs


def symmetric(matrix):
    return Symmetric(matrix.toarray())


@pytest.mark.parametrize("shift", SHIFTS)
def test_the_fold_of_bratu_in_one_dimension(shift):
    """The condition number of M is 3e6, of which a backward stable solver may lose 6e-10; the margin here is 100."""
    system = bordered_at(fold_1d, shift)
    truth, sign = in_sixty_digits(*system)
    assert sign == 1
    structures = [tridiagonal, csc_array, *([symmetric] if abs(shift) in (0.0, 1e-15, 1e-3) else [])]
    check(structures, system, truth, 2e-11, {1})


@pytest.mark.parametrize("shift", SHIFTS)
def test_the_fold_of_bratu_in_two_dimensions(shift):
    matrix, column, row, rhs = system = bordered_at(fold_2d, shift)
    square = np.block([[matrix.toarray(), column[:, None]], [row[None, :]]])
    signs = {0, np.linalg.slogdet(square)[0]}
    check((csc_array, symmetric, aslinearoperator), system, in_long_double(square, rhs), 5e-13, signs)


def test_regular_points_are_solved_in_the_band():
    matrix, column, row, _ = bordered_at(fold_1d, -1.0)
    assert isinstance(factor_bordered(tridiagonal(matrix), column, row), BlockElimination)


def test_krylov_uses_its_preconditioner():
    """With the exact inverse of H_y - I the bordered operator is solved in a handful of products."""
    at_fold, column, row, rhs = bordered_at(fold_1d, 0.0)
    n = len(column)
    near = splu(csc_array(at_fold - eye_array(n)))
    products = 0

    def product(x):
        nonlocal products
        products += 1
        return at_fold @ x

    operator = LinearOperator((n, n), matvec=product, dtype=float)
    preconditioned = Operator(operator, LinearOperator((n, n), matvec=near.solve, dtype=float))
    z = factor_bordered(preconditioned, column, row).solve(rhs[:-1], rhs[-1])
    truth, _ = in_sixty_digits(at_fold, column, row, rhs)
    assert np.abs(z - truth).max() <= 1e-10 * np.abs(truth).max()
    assert products < 100
    with pytest.raises(SingularError, match=r"did not converge.*preconditioner"):
        factor_bordered(operator, column, row).solve(rhs[:-1], rhs[-1])
