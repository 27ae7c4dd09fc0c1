"""Problems from files: every format gives the same problem; defects are in `test_hostile_files.py`."""

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


@pytest.mark.parametrize(
    ("name", "size", "write", "message"),
    [
        ("x0.npy", 4, lambda path: np.save(path, Q), r"x0: expected 4 numbers, found 3, in"),
        ("x0.npy", 2, lambda path: np.save(path, [1.0, np.nan]), r"x0: expected finite numbers, found nan at index 1"),
        ("x0.npz", 3, lambda path: np.savez(path, y=Q), r"x0: expected an array x0, found y, in"),
        ("x0.npy", 3, lambda path: None, r"x0: expected a file, found nothing"),
    ],
)
def test_vectors_are_checked_under_their_name(tmp_path, name, size, write, message):
    write(tmp_path / name)
    with pytest.raises(InputError, match=message) as caught:
        read_vector("x0", tmp_path / name, size)
    assert caught.value.argument == "x0"
