"""What comes through the door of `LCP`: sound, or refused in one line that names the argument."""

from copy import deepcopy
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp

from problems.lcp import LCP, classify

A, Q = [[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0]


COMPRESSED = [
    ("indices", 0, 7), ("indices", 0, -1), ("indices", 0, 10**6), ("indices", 0, -(10**6)), ("indices", 0, 2**31 - 1),
    ("indptr", 2, 0), ("indptr", 1, 99), ("indptr", 1, 10**8), ("indptr", 1, -5),
]  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "array", "place", "value", "found"),
    [
        *((kind, *wrong, "") for kind in (sp.csr_array, sp.csc_array, sp.csr_matrix) for wrong in COMPRESSED),
        (sp.coo_array, "row", 1, 5, "axis [01] index 5 exceeds matrix dimension 4"),
    ],
)
@pytest.mark.parametrize("read", [lambda matrix: LCP(matrix, -np.ones(4)), classify])
def test_indices_outside_of_the_shape_are_refused(read, kind, array, place, value, found):
    """They crash the process where they are believed."""
    matrix = kind(np.eye(4) * 2 + np.diag(np.ones(3), 1))
    getattr(matrix, array)[place] = value
    with pytest.raises(ValueError, match=f"A: expected a sparse matrix whose indices fit its shape, found .*{found}"):
        read(matrix)


def coo(data, rows, columns):
    return sp.coo_array((np.array(data), (rows, columns)), shape=(2, 2))


BYTES = np.array([100, 100, 1, 1, 127], np.int8)
"""That add up as numbers."""


SOUND = {
    "duplicates": coo([1, 1, 1, 0.5, 0.5, 2], [0, 0, 0, 1, 1, 1], [0, 0, 1, 0, 0, 1]),
    "unsorted": sp.csr_array((np.array([1.0, 2, 2, 1]), np.array([1, 0, 1, 0]), np.array([0, 2, 4])), shape=(2, 2)),
    "64 bits": sp.csr_array((np.array([2.0, 1, 1, 2]), np.array([0, 1, 0, 1], "i8"), np.array([0, 2, 4], "i8"))),
    **{form: sp.coo_array(np.array(A)).asformat(form) for form in ("bsr", "coo", "csc", "csr", "dia", "dok", "lil")},
    "int8": sp.csr_array(np.array(A, np.int8)),
}


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


CASES = {
    **{name: (given, A) for name, given in {**SOUND, **NUMBERS}.items()},
    "bytes, coo": (coo(BYTES, [0, 0, 0, 1, 1], [0, 0, 1, 0, 1]), [[200.0, 1.0], [1.0, 127.0]]),
    "bytes, csr": (sp.csr_array((BYTES, [0, 0, 1, 0, 1], [0, 3, 5]), shape=(2, 2)), [[200.0, 1.0], [1.0, 127.0]]),
}


@pytest.mark.parametrize(("given", "expected"), CASES.values(), ids=CASES)
def test_sound_matrices_and_numbers_in_any_form(given, expected):
    before = deepcopy(given)
    found = LCP(given, Q).A
    dense = found.toarray() if sp.issparse(given) else found
    assert type(dense) is np.ndarray
    assert dense.dtype == float
    assert np.array_equal(dense, expected)
    if sp.issparse(given):
        assert (found.format, found.has_sorted_indices) == ("csr", True)
        assert np.array_equal(given.toarray(), before.toarray()), "the caller's matrix is left alone"
