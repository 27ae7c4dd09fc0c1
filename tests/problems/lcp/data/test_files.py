"""Problems from files: every format gives the same problem, and every defect one line that names it."""

import json

import h5py
import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp

from problems.lcp.data.files import InputError, read_problem, read_vector

A = np.array([[2.0, -1.0, 0.0], [0.5, 0.0, 3.0], [0.0, 1e-300, -7.25]])
Q = np.array([-1.0, 2.5, 1 / 3])


def write_h5(path, group="/", sparse=False):
    with h5py.File(path, "w") as file:
        at = file.require_group(group)
        at["q"] = Q
        if sparse:
            matrix = sp.csr_array(A)
            parts = {"data": matrix.data, "indices": matrix.indices, "indptr": matrix.indptr, "shape": matrix.shape}
            at.create_group("A").update(parts)
        else:
            at["A"] = A


CONTAINERS = {
    "p.npz": lambda path: np.savez(path, A=A, q=Q),
    "p.json": lambda path: path.write_text(json.dumps({"A": A.tolist(), "q": Q.tolist()})),
    "p.mat": lambda path: scipy.io.savemat(path, {"A": A, "q": Q}),
    "sparse.mat": lambda path: scipy.io.savemat(path, {"A": sp.csc_array(A), "q": Q[:, None]}, do_compression=True),
    "p.h5": write_h5,
    "archive.h5": lambda path: write_h5(path, "problem"),
    "sparse.h5": lambda path: write_h5(path, sparse=True),
}


@pytest.mark.parametrize("name", CONTAINERS)
def test_every_container_gives_the_same_numbers(tmp_path, name):
    CONTAINERS[name](tmp_path / name)
    problem = read_problem(f"{tmp_path}/{name}")
    assert problem.sparse == name.startswith("sparse")
    np.testing.assert_array_equal(problem.A.toarray() if problem.sparse else problem.A, A)
    np.testing.assert_array_equal(problem.q, Q)


VECTORS = {
    "q.npy": lambda path: np.save(path, Q),
    "q.txt": lambda path: np.savetxt(path, Q, fmt="%.17g"),
    "row.csv": lambda path: np.savetxt(path, Q[None], fmt="%.17g", delimiter=","),
    "q.json": lambda path: path.write_text(json.dumps(Q.tolist())),
    "q.mtx": lambda path: scipy.io.mmwrite(path, Q[:, None], precision=17),
    "sparse.mtx": lambda path: scipy.io.mmwrite(path, sp.coo_array(Q[:, None]), precision=17),
    "q.npz": lambda path: np.savez(path, q=Q, other=A),
}


@pytest.mark.parametrize("vector", VECTORS)
def test_every_form_of_a_vector(tmp_path, vector):
    np.save(tmp_path / "a.npy", A)
    VECTORS[vector](tmp_path / vector)
    np.testing.assert_array_equal(read_problem(tmp_path / "a.npy", tmp_path / vector).q, Q)
    np.testing.assert_array_equal(read_vector("q", tmp_path / vector, 3), Q)


def npz(**arrays):
    return lambda path: np.savez(path, **arrays)


def text(content):
    return lambda path: path.write_text(content)


BAD = {
    "missing": ("gone.npz", None, r"path: expected a file, found nothing at '.*gone.npz'"),
    "folder": ("folder.npz", lambda path: path.mkdir(), r"path: expected a file, found a directory"),
    "extension": ("p.doc", text("A"), r"path: expected one of .npz, .*, found .doc in"),
    "no extension": ("p", text("A"), r"path: expected one of .*, found no extension"),
    "not an npz": ("p.npz", text("hello"), r"path: expected a .npz file, found one that cannot be read"),
    "empty npz": ("p.npz", text(""), r"path: expected a .npz file, found one that cannot be read"),
    "pickle": ("p.npz", npz(A=np.array([[None]]), q=Q), r"path: expected a .npz file.*allow_pickle"),
    "names": ("p.npz", npz(M=A, q=Q), r"path: expected an array A, found M, q, in"),
    "no q": ("p.npz", npz(A=A), r"path: expected an array q, found A, in"),
    "not a mat": ("p.mat", text("hello"), r"path: expected a .mat file"),
    "not h5": ("p.h5", text("hello"), r"path: expected a .h5 file"),
    "h5 without": ("p.h5", lambda path: write_h5(path, "a/b"), r"path: expected a .h5 file.*none of A, q"),
    "q elsewhere": ("p.npy", lambda path: np.save(path, A), r"path: expected A and q, found one array in"),
    "broken json": ("p.json", text('{"A": ['), r"path: expected a .json file, found one that cannot be read"),
    "json number": ("p.json", text("3"), r"it holds 3, not an object with A and q"),
    "ragged": ("p.json", text('{"A": [[1, 2], [3]], "q": [1, 2]}'), r"path: A: expected real numbers"),
    "words": ("p.json", text('{"A": [["one"]], "q": [1]}'), r"path: A: expected real numbers"),
    "huge integer": ("p.json", text('{"A": [[1%s]], "q": [1]}' % ("0" * 400)), r"path: A: expected real numbers"),
    "NaN": ("p.npz", npz(A=np.array([[np.nan]]), q=Q[:1]), r"path: A: expected finite numbers, found nan"),
    "infinite q": ("p.npz", npz(A=np.eye(1), q=np.array([np.inf])), r"path: q: expected finite numbers, found inf"),
    "complex": ("p.npz", npz(A=np.eye(1) * 1j, q=Q[:1]), r"path: A: expected real numbers"),
    "not square": ("p.npz", npz(A=A[:2], q=Q), r"path: A: expected a square matrix, found shape \(2, 3\), in"),
    "shapes": ("p.npz", npz(A=A, q=Q[:2]), r"path: q: expected 3 numbers, one a row of A, found 2, in"),
    "empty": ("p.npz", npz(A=np.zeros((0, 0)), q=np.zeros(0)), r"path: A: expected a square matrix, found shape"),
    "q a matrix": ("p.npz", npz(A=A, q=A), r"path: q: expected a vector of real numbers, found shape \(3, 3\)"),
    "not mtx": ("p.mtx", text("1 2"), r"path: expected a .mtx file"),
    "empty text": ("p.txt", text("# nothing\n"), r"path: expected a .txt file.*it is empty"),
    "text of words": ("p.txt", text("one two"), r"path: expected a .txt file.*'one'"),
}


@pytest.mark.parametrize(("name", "write", "message"), BAD.values(), ids=BAD)
def test_bad_files_are_named_in_one_line(tmp_path, name, write, message):
    if write is not None:
        write(tmp_path / name)
    with pytest.raises(InputError, match=message) as caught:
        read_problem(tmp_path / name)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize(
    ("name", "size", "write", "message"),
    [
        ("x0.npy", 4, lambda path: np.save(path, Q), r"x0: expected 4 numbers, found 3, in"),
        ("x0.npy", 2, lambda path: np.save(path, [1.0, np.nan]), r"x0: expected finite numbers, found nan at index 1"),
        ("x0.npz", 3, npz(y=Q), r"x0: expected an array x0, found y, in"),
        ("x0.npy", 3, lambda path: None, r"x0: expected a file, found nothing"),
    ],
)
def test_vectors_are_checked_under_their_name(tmp_path, name, size, write, message):
    write(tmp_path / name)
    with pytest.raises(InputError, match=message) as caught:
        read_vector("x0", tmp_path / name, size)
    assert caught.value.argument == "x0"
