"""Bordered systems against exact rational arithmetic; what is singular or malformed is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import aslinearoperator

from continuation.linear import Banded, Operator, SingularError, factor_bordered

from ...exact import gauss_jordan
from ...util import share

EPS = np.finfo(float).eps


def banded(matrix, lower, upper):
    n = len(matrix)
    ab = np.full((lower + upper + 1, n), np.nan)  # what lies outside the matrix must never be read
    for i in range(n):
        for j in range(max(0, i - lower), min(n, i + upper + 1)):
            ab[upper + i - j, j] = matrix[i, j]
    return Banded(ab, lower, upper)


GENERAL = {
    "dense": np.array,
    "banded": lambda matrix: banded(matrix, len(matrix) - 1, len(matrix) - 1),
    "sparse": csc_array,
}
EVERY = GENERAL | {"operator": aslinearoperator}


def whole(matrix, column, row):
    return np.block([[matrix, column[:, None]], [row[None, :]]])


def exact(matrix, rhs):
    """Solution and sign of the determinant in rational arithmetic; (None, 0) for a singular matrix."""
    x, product = gauss_jordan(np.asarray(matrix, dtype=float).tolist(), np.asarray(rhs, dtype=float).tolist())
    return (None if x is None else np.array(x, dtype=float)), (product > 0) - (product < 0)


def integers(*shape):
    return arrays(np.int64, shape, elements=st.integers(-9, 9)).map(lambda a: a.astype(float))


@st.composite
def systems(draw, singular=None):
    """(H_y, H_lam, border, rhs) with integer entries: every number of the problem is exact."""
    n = draw(st.integers(1, 12))
    if draw(st.booleans()) if singular is None else singular:
        matrix = draw(integers(n, n - 1)) @ draw(integers(n - 1, n))
    else:
        matrix = draw(integers(n, n))
    return matrix, draw(integers(n)), draw(integers(n + 1)), draw(integers(n + 1))


def check(structure, system, rows):
    """Compare with the exact solution of the system whose rows were scaled by powers of two."""
    matrix, column, row, rhs = system
    square = whole(matrix, column, row)
    truth, sign = exact(square, rhs)
    assume(sign != 0)
    condition = np.linalg.cond(square, np.inf)
    assume(condition < 1e9)
    scaled, right = square * rows[:, None], rhs * rows
    factored = factor_bordered(structure(scaled[:-1, :-1]), scaled[:-1, -1], scaled[-1])
    z = factored.solve(right[:-1], float(right[-1]))
    assert factored.sign in ({0} if structure is aslinearoperator else {sign})
    assert np.abs(z - truth).max() <= 200 * EPS * condition * np.abs(truth).max()


@pytest.mark.parametrize(
    ("structures", "singular", "largest"),
    [(EVERY, None, 0), (EVERY, True, 0), (GENERAL, None, 27)],
    ids=["any", "singular H_y", "units of rows"],
)
@given(data=st.data())
@share(60)
def test_systems_are_solved_by_every_structure_whatever_the_units_of_the_rows(structures, singular, largest, data):
    system, name = data.draw(systems(singular=singular)), data.draw(st.sampled_from(sorted(structures)))
    exponents = data.draw(arrays(np.int64, (len(system[3]),), elements=st.integers(-largest, largest)))
    check(structures[name], system, rows=2.0**exponents)


# Of order one; and [[1e-18, 1], [1, 1]], the classic failure of elimination without pivoting, in the unit of a row.
@pytest.mark.parametrize(
    ("matrix", "column", "row", "rhs", "z"),
    [(0.0, 2.0, [4.0, 1.0], [6.0, 7.0], [1.0, 3.0]), (1.0, 2.0**60, [1.0, 1.0], [2.0**60, 2.0], [1.0, 1.0])],
    ids=["order one", "a large row"],
)
@pytest.mark.parametrize("name", sorted(GENERAL))
def test_small_systems_are_solved_to_the_last_bits(name, matrix, column, row, rhs, z):
    factored = factor_bordered(EVERY[name](np.array([[matrix]])), np.array([column]), np.array(row))
    np.testing.assert_allclose(factored.solve(np.array(rhs[:1]), rhs[1]), z, rtol=4 * EPS)
    assert factored.sign == -1


SINGULAR = {
    "zero matrix and zero border": ([[0, 0], [0, 0]], [0, 0], [0, 0, 0]),
    "zero row": ([[1, 2], [0, 0]], [3, 0], [1, 1, 1]),
    "zero column": ([[2, 0], [0, 1]], [0, 0], [1, 1, 0]),
    "zero border": ([[2, 1], [1, 1]], [1, 2], [0, 0, 0]),
    "equal rows": ([[1, 2], [1, 2]], [3, 3], [1, 0, 1]),
    "border is a row": ([[2, 1], [1, 3]], [1, 2], [1, 3, 2]),
    "nullity two": ([[1, 0, 0], [0, 0, 0], [0, 0, 0]], [1, 1, 1], [1, 1, 1, 1]),
}


@pytest.mark.parametrize("case", sorted(SINGULAR))
@pytest.mark.parametrize("name", sorted(EVERY))
def test_singular_matrices_are_refused(name, case):
    matrix, column, row = (np.array(part, dtype=float) for part in SINGULAR[case])
    with pytest.raises(SingularError):
        factor_bordered(EVERY[name](matrix), column, row).solve(np.linspace(1, 2, len(column)), 1.0)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", sorted(EVERY))
def test_entries_that_are_not_finite_are_refused(name, bad):
    parts = np.array([[3.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 4.0]]), np.ones(3), np.arange(4.0)
    for k, index in ((0, np.ix_([1, 2], [1, 2])), (0, (0, 0)), (1, 1), (2, 0), (2, 3)):
        changed = [p.copy() for p in parts]
        changed[k][index] = bad
        with pytest.raises(SingularError, match="finite"):
            factor_bordered(EVERY[name](changed[0]), changed[1], changed[2])
    factored = factor_bordered(EVERY[name](parts[0]), *parts[1:])
    for r, rho in (([1.0, bad, 1.0], 0.0), (np.ones(3), bad)):
        with pytest.raises(SingularError):
            factored.solve(np.array(r), rho)


@pytest.mark.parametrize("name", sorted(EVERY))
def test_integer_and_fortran_ordered_arguments_are_taken_and_not_modified(name):
    matrix = np.asfortranarray([[4, 1, 0], [1, 3, 1], [0, 1, 2]])
    parts = matrix, np.array([1, 2, 3]), np.array([0, 0, 0, 1]), np.array([1, 2, 3])
    copies = [part.copy() for part in parts]
    factored = factor_bordered(matrix if name == "dense" else EVERY[name](matrix), *parts[1:3])
    truth, _ = exact(whole(*parts[:3]), [1, 2, 3, 4])
    np.testing.assert_allclose(factored.solve(parts[3], 4), truth, rtol=1e-13)
    for part, copy in zip(parts, copies):
        np.testing.assert_array_equal(part, copy)


@given(st.integers(1, 9), st.data())
def test_banded_is_the_matrix_that_it_stores(n, data):
    lower, upper = data.draw(st.integers(0, n + 1)), data.draw(st.integers(0, n + 1))
    offset = np.subtract.outer(np.arange(n), np.arange(n))
    matrix = np.where((offset <= lower) & (-offset <= upper), data.draw(integers(n, n)), 0.0)
    structured = banded(matrix, lower, upper)
    np.testing.assert_array_equal(structured.toarray(), matrix)
    np.testing.assert_array_equal(structured @ np.arange(1.0, n + 1), matrix @ np.arange(1.0, n + 1))
    np.testing.assert_array_equal(structured @ np.eye(n), matrix)
    assert structured.shape == (n, n)


PLAIN = csr_array(np.array([[2.0, 0.0, 1.0], [0.0, 0.0, 3.0], [1.0, 1.0, 0.0]]))
DOUBLED = csc_array(([1.0, 1.0, 3.0, 1.0, 1.0, 1.0], [2, 0, 1, 0, 0, 2], [0, 3, 4, 6]), shape=(3, 3))


@pytest.mark.parametrize(
    "matrix",
    [PLAIN, PLAIN.tocoo(), PLAIN.tolil(), DOUBLED],
    ids=["csr", "coo", "lil", "entries given twice"],
)
def test_sparse_matrices_of_any_format_are_taken(matrix):
    truth, sign = exact(whole(matrix.toarray(), np.ones(3), np.arange(4.0)), [1, 2, 3, 4])
    factored = factor_bordered(matrix, np.ones(3), np.arange(4.0))
    np.testing.assert_allclose(factored.solve(np.arange(1.0, 4.0), 4.0), truth, rtol=1e-13)
    assert factored.sign == sign
    # The argument is left as it was.
    assert matrix is not DOUBLED or DOUBLED.nnz == 6


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: factor_bordered([[1.0]], np.ones(1), np.ones(2)), TypeError, "list"),
        (lambda: factor_bordered(np.ones((2, 3)), np.ones(2), np.ones(3)), ValueError, r"\(2, 3\)"),
        (lambda: factor_bordered(np.ones((2, 2)), np.ones((2, 1)), np.ones(3)), ValueError, r"\(2, 1\)"),
        (lambda: factor_bordered(np.ones((2, 2)), np.ones(2), np.ones(2)), ValueError, r"\(2,\)"),
        (lambda: factor_bordered(np.ones((0, 0)), np.ones(0), np.ones(1)), ValueError, "N >= 1"),
        (lambda: factor_bordered(np.ones((1, 1)) * 1j, np.ones(1), np.ones(2)), TypeError, "H_y.*complex"),
        (lambda: factor_bordered(csc_array([[1j]]), np.ones(1), np.ones(2)), TypeError, "H_y.*complex"),
        (lambda: factor_bordered(np.ones((1, 1)), np.array([1j]), np.ones(2)), TypeError, "H_lam.*complex"),
        (lambda: factor_bordered(np.ones((1, 1)), np.ones(1), np.array(["a", "b"])), TypeError, "border"),
        (lambda: Banded(np.ones((2, 4)), 1, 1), ValueError, "ab of Banded"),
        (lambda: Banded(np.ones((1, 4)), -1, 1), ValueError, "lower"),
        (lambda: Banded(np.ones((1, 4)) * 1j, 0, 0), TypeError, "ab of Banded"),
        (lambda: Operator(aslinearoperator(np.eye(3)), aslinearoperator(np.eye(2))), ValueError, "preconditioner"),
        (lambda: banded(np.eye(3), 0, 0) @ np.ones(2), ValueError, "operand"),
    ],
)
def test_bad_arguments_and_structures_are_named(make, error, words):
    with pytest.raises(error, match=words):
        make()


@pytest.mark.parametrize("seed", [230, 2574])
def test_a_tangent_whose_units_differ_by_sixteen_decades(seed):
    """What is round-off in units of the problem is the largest entry of its row here: LU left an error of 0.8 %."""
    r, n = np.random.default_rng(seed), 3
    matrix, column = np.eye(n) - 1e-13 * (1.0 - np.eye(n)), np.array([1.0, 11.0, 11.0])
    matrix[0, 1:] = 0.0
    units, scales = (10.0 ** r.uniform(-8.0, 8.0, n) for _ in range(2))
    unit = 10.0 ** r.uniform(-8.0, 8.0)
    kernel = np.append(-column * units, unit)
    system = factor_bordered(scales[:, None] * matrix / units, scales * column / unit, 0.25 / kernel)
    np.testing.assert_allclose(system.solve(np.zeros(n), 1.0), kernel, rtol=1e-11)
