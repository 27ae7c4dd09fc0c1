"""LCPs and vectors read from files: whatever is wrong with one is said in one line.

A container (.npz, .json, .mat, .h5) holds named arrays, ``A`` and ``q``; the other formats hold one array a file.
"""

from __future__ import annotations

import json
import math
import re
import warnings
import zipfile
import zlib
from collections.abc import Callable, Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.io
import scipy.sparse as sp

from continuation.archive.datasets import dataset, member, subgroup
from continuation.archive.image import Image
from continuation.arrays import Array, Matrix
from problems.lcp.data.matlab import read_level5
from problems.lcp.data.models import MODEL_FORMATS, read_model
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.data.program import Program, from_lp, from_qp
from problems.options import finite_vector, sound_sparse

ALONE = ""
"""The name of the array in a file that holds one array without a name."""

LIMIT = 1 << 32
"""Bytes that a compressed file may unfold to; one that is not compressed is as large as it is."""

ROWS = 1 << 22
"""Rows of a sparse matrix, or as many as its file has bytes: each takes memory, also where it has no entry."""

_UNREADABLE = (
    OSError, ValueError, TypeError, KeyError, EOFError, RecursionError, NotImplementedError, OverflowError,
    MemoryError, RuntimeError, AttributeError, IndexError, zipfile.BadZipFile, zlib.error, scipy.io.matlab.MatReadError,
)  # fmt: skip

_BOUNDS = ("lower", "upper")

_CONTAINERS = re.compile(r"\.(?:npz|json|mat|h5|hdf5)(?:$|:)", re.IGNORECASE)
"""In the name of a file that holds named arrays."""

_PROGRAM = ("P", "c", "G", "h", "A_eq", "b_eq", *_BOUNDS, "rows_lower")
"""The arguments of `from_qp`; a container with c in place of q is one of a program."""

_WANTED = ("A", "q", "x0", *_PROGRAM)
"""What is looked for in an HDF5 file, which may hold much else."""

_HDF5_GROUP = re.compile(r"(?P<file>.*\.(?:h5|hdf5)):(?P<group>.+)", re.IGNORECASE)


class InputError(ValueError):
    """A file that cannot be used.

    Attributes
    ----------
    argument : str
        The argument at fault: ``path``, or the name of a vector.
    complaint : str
        What was expected and what was found, one line.
    """

    def __init__(self, argument: str, complaint: str) -> None:
        self.argument = argument
        self.complaint = " ".join(complaint.split())
        super().__init__(f"{self.argument}: {self.complaint}")


def read_problem(path: str | PathLike[str], q: str | PathLike[str] | None = None) -> MixedLCP:
    """Read LCP(q, A), or a problem with bounds, from a file.

    Parameters
    ----------
    path : path
        ``.npz``, ``.json``, ``.mat`` (before 7.3) or ``.h5`` with A and q, and lower and upper bounds if there are any,
        in which JSON's null, as an infinity, is none (in HDF5 at the root, in a group ``problem``
        or in the group named as ``file.h5:/group``); or, with `q` given, A alone as ``.mtx``, ``.npy``, ``.txt``,
        ``.csv`` or the ``.npz`` of `scipy.sparse.save_npz`. A sparse A stays sparse.
    q : path, optional
        A file with q, in any of these formats. It takes precedence over a q beside A.

    Raises
    ------
    InputError
        A ValueError: if a file is missing, of another format, or holds no real finite data of matching shapes.
    """
    contents = _contents("path", path)
    A = _named(contents, "A", "path", path)
    if q is None:
        if ALONE in contents:
            raise InputError("path", f"expected A and q, found one array in {_shown(path)}; give q in its own file")
        vector = _named(contents, "q", "path", path)
    else:
        vector = _named(_contents("q", q), "q", "q", q)
    try:
        problem: MixedLCP = LCP(A, _flat(vector))
        if any(name in contents for name in _BOUNDS):
            problem = MixedLCP(A, _flat(vector), *(_bound(contents, name, path) for name in _BOUNDS))
        if problem.n == 0:
            raise ValueError("A: expected a square matrix, found shape (0, 0)")
        return problem
    except (ValueError, TypeError, OverflowError) as error:
        at_q = q is not None and str(error).startswith("q:")
        argument, file = ("q", q) if at_q else ("path", path)
        raise InputError(argument, f"{str(error).removeprefix('q: ') if at_q else error}, in {_shown(file)}") from None


def read_program(path: str | PathLike[str]) -> Program | None:
    """Read a quadratic or linear program from a file; None where it holds none.

    Parameters
    ----------
    path : path
        ``.npz``, ``.json``, ``.mat`` or ``.h5`` with c and, where there are any, P, G, h, A_eq, b_eq, lower, upper and
        rows_lower, as for `from_qp`; or ``.qps``, ``.mps`` or ``.lp``, which need highspy.

    Raises
    ------
    InputError
        As for `read_problem`.
    """
    if Path(path).suffix.lower() in MODEL_FORMATS and Path(path).is_file():
        try:
            return read_model(fspath(path))
        except (ValueError, ImportError) as error:
            raise InputError("path", f"{error}, in {_shown(path)}") from None
    if not _CONTAINERS.search(fspath(path)):
        return None
    contents = _contents("path", path)
    if "c" not in contents or "q" in contents or "A" in contents:
        return None
    given: dict[str, Any] = {}
    for name in _PROGRAM:
        if name in contents and name in ("h", *_BOUNDS, "rows_lower"):
            given[name] = _bound(contents, name, path)
        elif name in contents:
            value = _named(contents, name, "path", path)
            given[name] = _flat(value) if name in ("c", "b_eq") else value
    try:
        return from_lp(**given) if "P" not in given else from_qp(**given)
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError("path", f"{error}, in {_shown(path)}") from None


def _bound(contents: Mapping[str, Any], name: str, path: str | PathLike[str]) -> Any:
    """A vector of bounds, None in a list of JSON being none."""
    if name not in contents:
        return None
    value = contents[name]
    if isinstance(value, list):
        none = -math.inf if name in ("lower", "rows_lower") else math.inf
        value = [none if entry is None else entry for entry in value]
    return _flat(_named({name: value}, name, "path", path))


def read_matrix(path: str | PathLike[str]) -> Matrix:
    """Read A alone, not checked; any of the formats of `read_problem`.

    Raises
    ------
    InputError
        If the file is missing, of another format, or holds no A.
    """
    return _named(_contents("path", path), "A", "path", path)


def read_vector(name: str, path: str | PathLike[str], size: int) -> Array:
    """Read `size` finite numbers, called `name` in messages and in a container, from a file.

    Raises
    ------
    InputError
        As for `read_problem`.
    """
    value = _flat(_named(_contents(name, path), name, name, path))
    try:
        return finite_vector(name, value, size)
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(name, f"{str(error).removeprefix(f'{name}: ')}, in {_shown(path)}") from None


def _contents(argument: str, path: str | PathLike[str]) -> Mapping[str, Any]:
    """The named arrays of a file."""
    file, group = _parted(path)
    suffix = Path(file).suffix.lower()
    if not Path(file).exists():
        raise InputError(argument, f"expected a file, found nothing at {_shown(file)}")
    if not Path(file).is_file():
        raise InputError(argument, f"expected a file, found a directory or a device at {_shown(file)}")
    if suffix not in _READERS:
        known = ", ".join(_READERS)
        raise InputError(argument, f"expected one of {known}, found {suffix or 'no extension'} in {_shown(file)}")
    try:
        # Sizes that a head claims overflow when they are multiplied.
        with np.errstate(over="ignore"):
            return _hdf5(file, group) if suffix in (".h5", ".hdf5") else _READERS[suffix](file)
    except _UNREADABLE as error:
        reason = str(error) or type(error).__name__
        complaint = f"expected a {suffix} file, found one that cannot be read: {_shown(file)} ({reason})"
        raise InputError(argument, complaint) from None


def _parted(path: str | PathLike[str]) -> tuple[str, str | None]:
    """The file, and the group in it."""
    text = fspath(path)
    grouped = _HDF5_GROUP.fullmatch(text)
    return (grouped["file"], grouped["group"]) if grouped else (text, None)


def _named(contents: Mapping[str, Any], name: str, argument: str, path: str | PathLike[str]) -> Matrix:
    """The array of that name, or the only one of a file without names; sparse, or an array of anything but objects."""
    if name not in contents and ALONE not in contents:
        found = ", ".join(sorted(contents)) or "nothing"
        raise InputError(argument, f"expected an array {name}, found {found} in {_shown(path)}")
    value = contents.get(name, contents.get(ALONE))
    try:
        if sp.issparse(value):
            if max(value.shape) > max(ROWS, Path(_parted(path)[0]).stat().st_size):
                raise ValueError(f"it claims the shape {value.shape}, and is too small for that")
            return sound_sparse(name, value)
        array = np.asarray(value)
        return array.astype(float) if array.dtype == object else array
    except (ValueError, TypeError, OverflowError) as error:
        complaint = f"{name}: expected real numbers in rows of one length, found others in {_shown(path)} ({error})"
        raise InputError(argument, complaint) from None


def _shown(path: str | PathLike[str] | None) -> str:
    return repr(str(path))


def _flat(value: Matrix) -> Matrix:
    """A row or a column as a vector, anything else as it is: which of them a format has is its own affair."""
    array = value.toarray() if sp.issparse(value) else value
    return array.ravel() if array.ndim == 2 and 1 in array.shape else array


def _claims(size: int, file: str) -> None:
    """Whether so many bytes are to be unpacked from a file: not more than it has, nor than a limit where it is packed.

    Raises
    ------
    ValueError
        If they are more.
    """
    if size > max(LIMIT, Path(file).stat().st_size):
        raise ValueError(f"it claims {size} bytes, expected at most {LIMIT} where a file is compressed")


def _npz(file: str) -> Mapping[str, Any]:
    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            _claims(sum(part.file_size for part in archive.infolist()), file)
    stored = np.load(file, mmap_mode="r", allow_pickle=False)
    if not isinstance(stored, np.lib.npyio.NpzFile):
        raise ValueError("it holds one array, not named arrays")
    with stored:
        if {"format", "shape", "data"} <= set(stored.files):
            return {ALONE: sp.load_npz(file)}
        return {name: stored[name] for name in stored.files}


def _npy(file: str) -> Mapping[str, Any]:
    if zipfile.is_zipfile(file):
        raise ValueError("it holds named arrays, not one")
    # A map of the file is no larger than the file, whatever its head claims.
    return {ALONE: np.array(np.load(file, mmap_mode="r", allow_pickle=False))}


def _json(file: str) -> Mapping[str, Any]:
    value = json.loads(Path(file).read_text(encoding="utf-8"))
    if isinstance(value, dict):
        return value
    if isinstance(value, list):
        return {ALONE: value}
    raise ValueError(f"it holds {value!r}, not an object with A and q")


def _mat(file: str) -> Mapping[str, Any]:
    raw = Path(file).read_bytes()
    if 0 not in raw[:4]:
        return read_level5(raw, LIMIT)
    # Level 4, which begins with small numbers.
    try:
        with warnings.catch_warnings(action="error"):
            _claims(8 * sum(math.prod(shape) for _, shape, kind in scipy.io.whosmat(file) if kind != "sparse"), file)
            return {name: value for name, value in scipy.io.loadmat(file).items() if not name.startswith("__")}
    except UserWarning as warning:
        raise ValueError(str(warning)) from None


def _matrix_market(file: str) -> Mapping[str, Any]:
    rows, columns, entries, form, _, _ = scipy.io.mminfo(file)
    # A number and the end of its line take two bytes at least.
    if (rows * columns if form == "array" else entries) > Path(file).stat().st_size:
        raise ValueError(f"it claims {entries} entries, and is too short for them")
    return {ALONE: scipy.io.mmread(file)}


def _text(file: str) -> Mapping[str, Any]:
    text = Path(file).read_text(encoding="utf-8")
    rows = [line.split("#")[0].replace(",", " ").split() for line in text.splitlines()]
    numbers = [[float(number) for number in row] for row in rows if row]
    if not numbers:
        raise ValueError("it is empty")
    return {ALONE: np.array(numbers)}


def _hdf5(file: str, group: str | None = None) -> Mapping[str, Any]:
    image = Image(Path(file))
    try:
        with h5py.File(image, "r") as root:
            if group is not None:
                at = root
                for part in filter(None, group.split("/")):
                    if part not in at:
                        raise ValueError(f"no group {group}")
                    at = subgroup(at, part)
            else:
                nested = subgroup(root, "problem") if "problem" in root and "A" not in root else None
                at = root if nested is None else nested
            found = {name: _from_hdf5(at, name) for name in _WANTED if name in at}
            if not found:
                raise ValueError(f"none of {', '.join(_WANTED)} in its group {at.name}")
            return found
    finally:
        image.close()


def _from_hdf5(group: Any, name: str) -> Matrix:
    """A dataset, or the parts of a compressed sparse matrix in a group."""
    node = member(group, name)
    if isinstance(node, h5py.Dataset):
        return dataset(group, name, None, None, LIMIT)[()]
    parts = [dataset(node, part, None, (None,), LIMIT)[()] for part in ("data", "indices", "indptr")]
    shape = tuple(int(n) for n in (dataset(node, "shape", None, (2,))[()] if "shape" in node else node.attrs["shape"]))
    return sp.csr_array((parts[0], parts[1], parts[2]), shape=shape)


_READERS: Mapping[str, Callable[[str], Mapping[str, Any]]] = {
    ".npz": _npz,
    ".json": _json,
    ".mat": _mat,
    ".h5": _hdf5,
    ".hdf5": _hdf5,
    ".mtx": _matrix_market,
    ".npy": _npy,
    ".txt": _text,
    ".csv": _text,
}
