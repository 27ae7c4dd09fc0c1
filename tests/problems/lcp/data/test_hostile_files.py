"""Problem files made to harm, and damaged ones: refused in one line, or read as numbers; nothing is executed."""

import io
import json
import os
import pickle
import random
import resource
import struct
import zipfile
from functools import partial
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io

from problems.lcp.data.files import InputError, read_problem

from ....util import benchmark

A, Q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])


class Evil:
    """What a pickle makes of it leaves a file."""

    def __reduce__(self):
        return os.mkdir, ("executed",)


def npy_head(shape, kind="'<f8'"):
    head = f"{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}".encode()
    head = head.ljust(len(head) + -(len(head) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head


def saved(**arrays):
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def sparse(**parts):
    sound = {"format": b"csr", "shape": [2, 2], "data": np.ones(2), "indices": [0, 1], "indptr": [0, 1, 2]}
    return saved(**{name: np.array(value) for name, value in {**sound, **parts}.items()})


def zipped(*names):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.writestr(name, b"x")
    return file.getvalue()


def bomb():
    """5 GB of zeros, which are never made: only the head of the entry says so."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("A.npy", npy_head((25000, 25000)) + bytes(1000))
    raw = bytearray(file.getvalue())
    for signature, at in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        place = raw.find(signature) + at
        raw[place : place + 4] = (4_900_000_000 % 2**32 or 1).to_bytes(4, "little")
    return bytes(raw)


MTX = "%%MatrixMarket matrix {} real general\n{}\n"
HOSTILE = {
    "pickle.npy": pickle.dumps(Evil()),
    "pickle.npz": pickle.dumps(Evil()),
    "objects.npz": saved(A=np.array([[1]]), q=Q) + pickle.dumps(Evil()),
    "object.npy": npy_head((1,), "'|O'") + pickle.dumps(Evil()),
    "object.npz": saved(A=np.array([[Evil()]], object), q=Q),
    "format.npz": sparse(format=np.array([Evil()], object)),
    "class.npz": sparse(format=b"__class__"),
    "linalg.npz": sparse(format=b"linalg"),
    "index.npz": sparse(indices=[0, 10**6]),
    "negative.npz": sparse(indices=[0, -7]),
    "starts.npz": sparse(indptr=[0, 99, 2]),
    "falling.npz": sparse(indptr=[2, 1, 0]),
    "shape.npz": sparse(shape=[10**9, 10**9]),
    "words.npz": sparse(shape=["a", "b"]),
    "names.npz": zipped(*(f"a{k}.npy" for k in range(2000))),
    "above.npz": zipped("../../A.npy"),
    "bomb.npz": bomb(),
    "large.npy": npy_head((10**5, 10**5)),
    "larger.npy": npy_head((10**12, 10**12)),
    "less.npy": npy_head((-1, 2)),
    "call.npy": npy_head("(__import__('os').mkdir('executed'),)"),
    "deep.npy": npy_head("(" * 20000),
    "deep.json": b"[" * 200_000,
    "deeper.json": b'{"A":' * 100_000,
    "nan.json": b'{"A": [[NaN]], "q": [1]}',
    "digits.json": b'{"A": [[' + b"9" * 5000 + b']], "q": [1]}',
    "exponent.json": b'{"A": [[1e999]], "q": [1]}',
    "null.json": b'{"A": null, "q": null}',
    "text.json": b'{"A": [["1"]], "q": ["1"]}',
    "twice.json": b'{"A": [[1, 0], [0, 1]], "A": [[2, 0], [0, 2]]}',
    "bytes.json": b"\xff\xfe{",
    "empty.json": b"",
    "loop.mat": struct.pack("<iiiii", 50, -1, 22, 0, 2) + b"A\0",
    "seven.mat": b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM" + bytes(400),
    "dims.mtx": MTX.format("coordinate", "1000000000 1000000000 1\n1 1 1.0").encode(),
    "entries.mtx": MTX.format("coordinate", "2 2 1000000000000\n1 1 1.0").encode(),
    "array.mtx": MTX.format("array", "1000000 1000000\n1.0").encode(),
    "minus.mtx": MTX.format("coordinate", "-2 2 1\n1 1 1.0").encode(),
    "outside.mtx": MTX.format("coordinate", "2 2 1\n5 5 1.0").encode(),
    "zero.mtx": MTX.format("coordinate", "2 2 1\n0 0 1.0").encode(),
    "nan.mtx": MTX.format("coordinate", "2 2 2\n1 1 nan\n2 2 1").encode(),
    "cut.mtx": b"%%MatrixMarket matrix array real symmetric\n%\n3 3\n2\n-1\n0\n2\n-1",
    **{f"{k}.mtx": MTX.format("coordinate", f"2 2 2\n1 1 {word}\n2 2 1").encode() for k, word in enumerate(
        ("1.5x7", "1.5.7", "1.5-7", "1e2e3", "1,5", "0x10", "1\x007"))},
    "more.mtx": MTX.format("coordinate", "2 2 2\n1 1 1.0\n2 2 1.0\n1 2 5.0").encode(),
    "skew.mtx": b"%%MatrixMarket matrix array real skew-symmetric\n3 3\n1\n2\n",
    "complex.mtx": b"%%MatrixMarket matrix array complex hermitian\n2 2\n1 0\n2 0\n",
    "rows.mtx": b"%%MatrixMarket matrix array real symmetric\n2 3\n1\n2\n3\n",
    "empty.mtx": MTX.format("array", "0 4000000000").encode(),
    "none.mtx": MTX.format("coordinate", "0 0 0").encode(),
    "huge.mtx": MTX.format("array", f"{2**62} {2**62}").encode(),
    "bracket.npy": npy_head("(2, 2"),
    "head.csv": b"a,b\n1,2\n3,4\n",
    "ragged.csv": b"1 2\n3\n",
    "hex.csv": b"0x10 1\n1 1\n",
    "comma.csv": b"1,5 2,5\n3,5 4,5\n",
    "cell.csv": b"1,,2\n3,,4\n",
    "first.csv": b",1,2\n,3,4\n",
    "nul.csv": b"1 \x00\n1 1\n",
}  # fmt: skip


WHOLE = {
    "json": lambda file: file.write(json.dumps({"A": A.tolist(), "q": Q.tolist()}).encode()),
    "npz": lambda file: np.savez(file, A=A, q=Q),
    "packed.npz": lambda file: np.savez_compressed(file, A=A, q=Q),
}


@pytest.mark.parametrize("form", WHOLE)
def test_damaged_files(tmp_path, form):
    """Bytes changed at random, and ends cut off: an error of one line, or numbers; in a process that is not to die."""
    memory, file, generator = io.BytesIO(), tmp_path / f"p.{form.rpartition('.')[2]}", random.Random(7)
    WHOLE[form](memory)
    raw = memory.getvalue()

    def read():
        # What a damaged size asks for is not to be had from the machine, nor to be taken.
        resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
        before, said = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, ""
        for _ in range(40):
            damaged = bytearray(raw)
            for _ in range(generator.choice((1, 1, 3))):
                damaged[generator.randrange(len(raw))] = generator.randrange(256)
            if generator.random() < 0.2:
                del damaged[generator.randrange(len(raw)) :]
            file.write_bytes(damaged)
            try:
                read_problem(file)
            except InputError as error:
                said += str(error)
        return "\n" not in said and resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 400 << 10

    assert benchmark("archive_kills.py").child(read).answer


def parts(file, indices, indptr, shape=(2, 2)):
    file["A"].attrs["shape"] = shape
    for name, value in {"data": np.ones(2), "indices": indices, "indptr": indptr}.items():
        file["A"][name] = value


HARM = {
    "an index outside": lambda file: parts(file, [0, 99], [0, 1, 2]),
    "starts that fall": lambda file: parts(file, [0, 1], [0, 2, -5, 2], (3, 3)),
    "a large shape": lambda file: parts(file, [0, 1], [0, 1, 2], (10**9, 10**9)),
    "no parts": lambda file: None,
    "a link": lambda file: file.pop("A") and file.__setitem__("A", h5py.SoftLink("/q")),
    "a link elsewhere": lambda file: file.pop("A") and file.__setitem__("A", h5py.ExternalLink("other.h5", "/A")),
    "entries that nobody stored": lambda file: file["A"].create_dataset("data", (10**8,), "f8", chunks=(1000,)),
    "names elsewhere": lambda file: file.move("A", "a/b/A") or file.move("q", "a/b/q"),
}


def harmed(harm, path):
    with h5py.File(path, "w") as file:
        file["q"] = Q
        file.create_group("A")
        HARM[harm](file)


BAD = {
    "extension": ("p.doc", b"A", r"path: expected one of .npz, .*, found .doc in"),
    "no extension": ("p", b"A", r"path: expected one of .*, found no extension"),
    "not an npz": ("p.npz", b"hello", r"path: expected a .npz file, found one that cannot be read"),
    "empty npz": ("p.npz", b"", r"path: expected a .npz file, found one that cannot be read"),
    "pickle": ("p.npz", saved(A=np.array([[None]]), q=Q), r"path: expected a .npz file.*allow_pickle"),
    "names": ("p.npz", saved(M=A, q=Q), r"path: expected an array A, found M, q, in"),
    "no q": ("p.npz", saved(A=A), r"path: expected an array q, found A, in"),
    "not a mat": ("p.mat", b"hello", r"path: expected a .mat file"),
    "not h5": ("p.h5", b"hello", r"path: expected a .h5 file"),
    "broken json": ("p.json", b'{"A": [', r"path: expected a .json file, found one that cannot be read"),
    "json number": ("p.json", b"3", r"path: expected A and q, found one array in"),
    "ragged": ("p.json", b'{"A": [[1, 2], [3]], "q": [1, 2]}', r"path: A: expected real numbers"),
    "words": ("p.json", b'{"A": [["one"]], "q": [1]}', r"path: A: expected real numbers"),
    "huge integer": ("p.json", b'{"A": [[1%s]], "q": [1]}' % (b"0" * 400), r"path: A: expected real numbers"),
    "NaN": ("p.npz", saved(A=np.array([[np.nan]]), q=Q[:1]), r"path: A: expected finite numbers, found nan"),
    "infinite q": ("p.npz", saved(A=np.eye(1), q=np.array([np.inf])), r"path: q: expected finite numbers, found inf"),
    "infinite": ("p.json", b'{"A": [[1]], "q": [-Infinity]}', r"path: q: expected finite numbers, found -inf"),
    "complex": ("p.npz", saved(A=np.eye(1) * 1j, q=Q[:1]), r"path: A: expected real numbers"),
    "not square": (
        "p.npz",
        saved(A=np.ones((2, 3)), q=Q),
        r"path: A: expected a square matrix, found shape \(2, 3\), in",
    ),
    "shapes": ("p.npz", saved(A=np.eye(3), q=Q), r"path: q: expected 3 numbers, one a row of A, found 2, in"),
    "empty": ("p.npz", saved(A=np.zeros((0, 0)), q=np.zeros(0)), r"path: A: expected a square matrix, found shape"),
    "q a matrix": ("p.npz", saved(A=A, q=A), r"path: q: expected a vector of real numbers, found shape \(2, 2\)"),
    "not mtx": ("p.mtx", b"1 2", r"path: expected a .mtx file"),
    "empty text": ("p.txt", b"# nothing\n", r"path: expected a .txt file.*it is empty"),
    "text of words": ("p.txt", b"one two", r"path: expected a .txt file.*'one'"),
}
MADE = {
    "missing": ("gone.npz", lambda path: None, r"path: expected a file, found nothing at '.*gone.npz'"),
    "folder": ("folder.npz", Path.mkdir, r"path: expected a file, found a directory"),
    "q elsewhere": ("p.npy", lambda path: np.save(path, A), r"path: expected A and q, found one array in"),
    "unfolds to much": (
        "p.npz",
        lambda path: np.savez_compressed(path, A=np.zeros((4200, 4200)), q=Q),
        "claims 141",
    ),
    "more zeros than it may hold": (
        "p.mat",
        lambda path: scipy.io.savemat(path, {"A": np.zeros((4200, 4200)), "q": Q}, do_compression=True),
        "cannot be read",
    ),
    **{harm: ("p.h5", partial(harmed, harm), r"none of A, q" if "names" in harm else "^path: ") for harm in HARM},
}
CASES = {
    **{name: (name, partial(Path.write_bytes, data=data), "^(path|q): ", "q.txt") for name, data in HOSTILE.items()},
    **{case: (name, partial(Path.write_bytes, data=data), said, None) for case, (name, data, said) in BAD.items()},
    **{case: (*made, None) for case, made in MADE.items()},
}  # fmt: skip


@pytest.mark.parametrize(("name", "write", "message", "vector"), CASES.values(), ids=CASES)
def test_one_line_and_nothing_done(tmp_path, monkeypatch, name, write, message, vector):
    monkeypatch.chdir(tmp_path)
    write(tmp_path / name)
    np.savetxt("q.txt", Q)
    with pytest.raises(InputError, match=message) as caught:
        read_problem(name, vector)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert not os.path.exists("executed")
