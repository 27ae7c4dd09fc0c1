"""The formats of files that hold arrays: each is read into named arrays, whatever they may be called."""

from __future__ import annotations

import json
import math
import re
import warnings
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.io
import scipy.sparse as sp

from continuation.archive.datasets import dataset, member, subgroup
from continuation.archive.image import Image
from continuation.arrays import Matrix
from problems.lcp.data.matlab import read_level5

ALONE = ""
"""The name of the array in a file that holds one array without a name."""

FILE_BYTES = 1 << 32
"""Bytes that a compressed file may unfold to; one that is not compressed is as large as it is."""

BOUNDS = ("lower", "upper")

PROGRAM = ("P", "c", "G", "h", "A_eq", "b_eq", *BOUNDS, "rows_lower")
"""The arguments of `from_qp`; a container with c in place of q is one of a program."""

WANTED = ("A", "q", "x0", *PROGRAM)
"""What is looked for in an HDF5 file, which may hold much else."""


def _claims(size: int, file: str) -> None:
    """Whether so many bytes are to be unpacked from a file: not more than it has, nor than a limit where it is packed.

    Raises `ValueError` if they are more.
    """
    if size > max(FILE_BYTES, Path(file).stat().st_size):
        raise ValueError(f"it claims {size} bytes, expected at most {FILE_BYTES} where a file is compressed")


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
    value = json.loads(Path(file).read_text(encoding="utf-8"), object_pairs_hook=_named_once)
    if isinstance(value, dict):
        return value
    if isinstance(value, list):
        return {ALONE: value}
    raise ValueError(f"it holds {value!r}, not an object with A and q")


def _named_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    named = dict(pairs)
    if len(named) < len(pairs):
        raise ValueError("it names something twice")
    return named


def _mat(file: str) -> Mapping[str, Any]:
    raw = Path(file).read_bytes()
    if 0 not in raw[:4]:
        return read_level5(raw, FILE_BYTES)
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
    lines = [line.split("#")[0] for line in text.splitlines()]
    for k, line in enumerate(lines, 1):
        if re.search(r"^\s*,|,\s*,", line):
            raise ValueError(f"line {k} has an empty cell")
    rows = [line.replace(",", " ").split() for line in lines]
    numbers = [[float(number) for number in row] for row in rows if row]
    if not numbers:
        raise ValueError("it is empty")
    return {ALONE: np.array(numbers)}


def read_hdf5(file: str, group: str | None = None) -> Mapping[str, Any]:
    """The arrays wanted in a group of an HDF5 file: its root, or `problem` in it, where none is named."""
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
            found = {name: _from_hdf5(at, name) for name in WANTED if name in at}
            if not found:
                raise ValueError(f"none of {', '.join(WANTED)} in its group {at.name}")
            return found
    finally:
        image.close()


def _from_hdf5(group: Any, name: str) -> Matrix:
    """A dataset, or the parts of a compressed sparse matrix in a group."""
    node = member(group, name)
    if isinstance(node, h5py.Dataset):
        return dataset(group, name, None, None, FILE_BYTES)[()]
    parts = [dataset(node, part, None, (None,), FILE_BYTES)[()] for part in ("data", "indices", "indptr")]
    shape = tuple(int(n) for n in (dataset(node, "shape", None, (2,))[()] if "shape" in node else node.attrs["shape"]))
    return sp.csr_array((parts[0], parts[1], parts[2]), shape=shape)


READERS: Mapping[str, Callable[[str], Mapping[str, Any]]] = {
    ".npz": _npz,
    ".json": _json,
    ".mat": _mat,
    ".h5": read_hdf5,
    ".hdf5": read_hdf5,
    ".mtx": _matrix_market,
    ".npy": _npy,
    ".txt": _text,
    ".csv": _text,
}
