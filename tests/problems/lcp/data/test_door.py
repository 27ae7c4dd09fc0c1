"""What comes through the door of `LCP`: sound, or refused in one line that names the argument."""

import os
from decimal import Decimal
from fractions import Fraction

import h5py
import numpy as np
import pytest
import scipy.sparse as sp

from problems.lcp import LCP
from problems.lcp.data.files import InputError, read_problem

A, Q = [[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0]


def corrupt(array, place, value):
    """A matrix of order 4 whose `array` holds something impossible."""
    matrix = sp.csr_array(np.eye(4) * 2 + np.diag(np.ones(3), 1))
    getattr(matrix, array)[place] = value
    return matrix


CORRUPT = {
    f"{array}[{place}] = {value}": (array, place, value)
    for array, place, value in [
        ("indices", 0, 7),
        ("indices", 0, -1),
        ("indices", 0, 10**6),
        ("indices", 0, -(10**6)),
        ("indices", 0, 2**31 - 1),
        ("indptr", 2, 0),
        ("indptr", 1, 99),
        ("indptr", 1, 10**8),
        ("indptr", 1, -5),
    ]
}


@pytest.mark.parametrize("case", CORRUPT)
@pytest.mark.parametrize("form", ["csr", "csc", "matrix", "h5", "npz"])
def test_indices_outside_of_the_shape_are_refused(tmp_path, case, form):
    """They crash the process where they are believed."""
    matrix = corrupt(*CORRUPT[case])
    parts = matrix.data, matrix.indices, matrix.indptr
    if form == "h5":
        with h5py.File(tmp_path / "p.h5", "w") as file:
            group = file.create_group("A")
            group.attrs["shape"] = [4, 4]
            for name, part in zip(("data", "indices", "indptr"), parts):
                group[name] = part
            file["q"] = -np.ones(4)
        with pytest.raises(InputError, match="path: "):
            read_problem(tmp_path / "p.h5")
    elif form == "npz":
        np.savez(tmp_path / "A.npz", format=b"csr", shape=[4, 4], data=parts[0], indices=parts[1], indptr=parts[2])
        (tmp_path / "q.txt").write_text("-1 -1 -1 -1")
        with pytest.raises(InputError, match="path: "):
            read_problem(tmp_path / "A.npz", tmp_path / "q.txt")
    else:
        other = {"csr": sp.csr_array, "csc": sp.csc_array, "matrix": sp.csr_matrix}[form](np.eye(4))
        other.data, other.indices, other.indptr = parts
        with pytest.raises(ValueError, match="A: expected a sparse matrix whose indices fit its shape"):
            LCP(other, -np.ones(4))


def coo(data, rows, columns, kind=float):
    return sp.coo_array((np.array(data, kind), (rows, columns)), shape=(2, 2))


def test_a_coo_whose_indices_were_changed():
    matrix = coo([1, 2], [0, 1], [0, 1])
    matrix.row[1] = 5
    with pytest.raises(ValueError, match=r"A: .* indices 0 to 5 where 0 to 1 are possible"):
        LCP(matrix, Q)


SOUND = {
    "duplicates": coo([1, 1, 1, 0.5, 0.5, 2], [0, 0, 0, 1, 1, 1], [0, 0, 1, 0, 0, 1]),
    "unsorted": sp.csr_array((np.array([1.0, 2, 2, 1]), np.array([1, 0, 1, 0]), np.array([0, 2, 4])), shape=(2, 2)),
    "64 bits": sp.csr_array((np.array([2.0, 1, 1, 2]), np.array([0, 1, 0, 1], "i8"), np.array([0, 2, 4], "i8"))),
    **{form: sp.coo_array(np.array(A)).asformat(form) for form in ("bsr", "coo", "csc", "csr", "dia", "dok", "lil")},
    "int8": sp.csr_array(np.array(A, np.int8)),
}


@pytest.mark.parametrize("case", SOUND)
def test_sound_matrices_in_any_form(case):
    given = SOUND[case].copy()
    found = LCP(SOUND[case], Q)
    assert found.A.format == "csr"
    assert np.array_equal(found.A.toarray(), A)
    assert found.A.has_sorted_indices
    assert np.array_equal(given.toarray(), SOUND[case].toarray()), "the caller's matrix is left alone"


@pytest.mark.parametrize("form", ["coo", "csr"])
def test_small_integers_add_up_as_numbers(form):
    matrix = coo([100, 100, 1, 1, 127], [0, 0, 0, 1, 1], [0, 0, 1, 0, 1], np.int8).asformat("coo")
    if form == "csr":
        parts = np.array([100, 100, 1, 1, 127], np.int8), np.array([0, 0, 1, 0, 1]), np.array([0, 3, 5])
        matrix = sp.csr_array(parts, shape=(2, 2))
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


@pytest.mark.parametrize("case", NUMBERS)
def test_numbers_of_any_kind_become_floats(case):
    found = LCP(NUMBERS[case], Q).A
    assert type(found) is np.ndarray
    assert found.dtype == float
    assert np.array_equal(found, A)


def test_a_pipe_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "p.h5")
    with pytest.raises(InputError, match="path: expected a file, found a directory or a device"):
        read_problem(tmp_path / "p.h5")


@pytest.mark.parametrize("kind", ["soft", "external", "virtual", "elsewhere"])
def test_an_hdf5_file_shows_only_what_is_in_it(tmp_path, kind):
    with h5py.File(tmp_path / "secret.h5", "w") as file:
        file["A"], file["q"] = np.array(A), np.array(Q)
    (tmp_path / "raw").write_bytes(np.array(A).tobytes())
    with h5py.File(tmp_path / "p.h5", "w") as file:
        file["q"] = np.array(Q)
        if kind == "soft":
            file["B"] = np.array(A)
            file["A"] = h5py.SoftLink("/B")
        elif kind == "external":
            file["A"] = h5py.ExternalLink(str(tmp_path / "secret.h5"), "/A")
        elif kind == "virtual":
            layout = h5py.VirtualLayout((2, 2), "f8")
            layout[:] = h5py.VirtualSource(str(tmp_path / "secret.h5"), "A", (2, 2))
            file.create_virtual_dataset("A", layout)
        else:
            file.create_dataset("A", (2, 2), "f8", external=[(str(tmp_path / "raw"), 0, 32)])
    with pytest.raises(InputError, match=r"path: .*(a link to somewhere else|stored outside of the file)"):
        read_problem(tmp_path / "p.h5")


def test_sizes_that_a_file_only_claims(tmp_path):
    with h5py.File(tmp_path / "p.h5", "w") as file:
        file.create_dataset("A", (10**6, 10**6), "f8", chunks=(1000, 1000))
        file["q"] = np.array(Q)
    head = b"\x93NUMPY\x01\x00v\x00" + b"{'descr': '<f8', 'fortran_order': False, 'shape': (100000, 100000), }"
    (tmp_path / "p.npy").write_bytes(head.ljust(127) + b"\n")
    (tmp_path / "p.mtx").write_text("%%MatrixMarket matrix array real general\n100000 100000\n1\n")
    for name in ("p.h5", "p.npy", "p.mtx"):
        with pytest.raises(InputError, match="path: expected a"):
            read_problem(tmp_path / name, tmp_path / name)
