"""What comes through the door of `LCP`: sound, or refused in one line that names the argument."""

from copy import deepcopy
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp

from problems.lcp import LCP

A, Q = [[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0]


@pytest.mark.parametrize(
    ("array", "place", "value"),
    [("indices", 0, 7), ("indices", 0, -1), ("indices", 0, 10**6), ("indices", 0, -(10**6)), ("indices", 0, 2**31 - 1),
     ("indptr", 2, 0), ("indptr", 1, 99), ("indptr", 1, 10**8), ("indptr", 1, -5)],
)  # fmt: skip
@pytest.mark.parametrize("kind", [sp.csr_array, sp.csc_array, sp.csr_matrix])
def test_indices_outside_of_the_shape_are_refused(array, place, value, kind):
    """They crash the process where they are believed."""
    matrix = kind(np.eye(4) * 2 + np.diag(np.ones(3), 1))
    getattr(matrix, array)[place] = value
    with pytest.raises(ValueError, match="A: expected a sparse matrix whose indices fit its shape"):
        LCP(matrix, -np.ones(4))


def coo(data, rows, columns, kind=float):
    return sp.coo_array((np.array(data, kind), (rows, columns)), shape=(2, 2))


def test_a_coo_whose_indices_were_changed():
    matrix = coo([1, 2], [0, 1], [0, 1])
    matrix.row[1] = 5
    with pytest.raises(ValueError, match=r"A: .* fit its shape, found axis [01] index 5 exceeds matrix dimension 2"):
        LCP(matrix, Q)


SOUND = {
    "duplicates": coo([1, 1, 1, 0.5, 0.5, 2], [0, 0, 0, 1, 1, 1], [0, 0, 1, 0, 0, 1]),
    "unsorted": sp.csr_array((np.array([1.0, 2, 2, 1]), np.array([1, 0, 1, 0]), np.array([0, 2, 4])), shape=(2, 2)),
    "64 bits": sp.csr_array((np.array([2.0, 1, 1, 2]), np.array([0, 1, 0, 1], "i8"), np.array([0, 2, 4], "i8"))),
    **{form: sp.coo_array(np.array(A)).asformat(form) for form in ("bsr", "coo", "csc", "csr", "dia", "dok", "lil")},
    "int8": sp.csr_array(np.array(A, np.int8)),
}


@pytest.mark.parametrize("form", ["coo", "csr"])
def test_small_integers_add_up_as_numbers(form):
    data = np.array([100, 100, 1, 1, 127], np.int8)
    places = ([0, 0, 0, 1, 1], [0, 0, 1, 0, 1]) if form == "coo" else None
    matrix = coo(data, *places, np.int8) if places else sp.csr_array((data, [0, 0, 1, 0, 1], [0, 3, 5]), shape=(2, 2))
    assert LCP(matrix, Q).A[0, 0] == 200.0


NUMBERS = {
    "fractions": [[Fraction(2), Fraction(1)], [Fraction(1), Fraction(2)]],
    "decimals": [[Decimal(2), Decimal(1)], [Decimal(1), Decimal(2)]],
    "long": np.array(A, np.longdouble),
    "half": np.array(A, np.float16),
    "other bytes": np.array(A, ">f8"),
    "nothing masked": np.ma.masked_array(A),
    "a matrix": np.array(A).view(np.matrix),
    "negative strides": np.array(A)[::-1, ::-1],
    "scalars as arrays": [[np.array(2.0), np.array(1.0)], [np.array(1.0), np.array(2.0)]],
}


@pytest.mark.parametrize("case", [*SOUND, *NUMBERS])
def test_sound_matrices_and_numbers_in_any_form(case):
    given = {**SOUND, **NUMBERS}[case]
    before = deepcopy(given)
    found = LCP(given, Q).A
    dense = found.toarray() if sp.issparse(given) else found
    assert type(dense) is np.ndarray
    assert dense.dtype == float
    assert np.array_equal(dense, A)
    if sp.issparse(given):
        assert (found.format, found.has_sorted_indices) == ("csr", True)
        assert np.array_equal(given.toarray(), before.toarray()), "the caller's matrix is left alone"
