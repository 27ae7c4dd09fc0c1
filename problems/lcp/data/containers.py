"""Readers of files that hold arrays."""

from __future__ import annotations

import json
import re
import sys
import warnings
import zipfile
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.io
import scipy.sparse as sp

from continuation.archive.hdf5 import Allowance, Image, dataset, member, subgroup
from continuation.arrays import Matrix
from problems.lcp.data.apart import read_apart

ALONE = ""
"""Name of an unnamed array."""

BOUNDS = ("lower", "upper")

PROGRAM = ("P", "c", "G", "h", "A_eq", "b_eq", *BOUNDS, "rows_lower")
"""The arguments of `from_qp`."""

WANTED = ("A", "q", "x0", *PROGRAM)
"""Names read from an HDF5 file."""


def _npz(file: str) -> Mapping[str, Any]:
    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            unfolded = sum(part.file_size for part in archive.infolist())
        Allowance(Path(file).stat().st_size).take("it", unfolded)
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
    # A map is no larger than the file.
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
    with warnings.catch_warnings(action="error"):
        held = scipy.io.loadmat(file, spmatrix=False)
        return {name: value for name, value in held.items() if not name.startswith("__")}


def _matrix_market(file: str) -> Mapping[str, Any]:
    rows, columns, entries, form, field, symmetry = scipy.io.mminfo(file)
    cells = rows * columns
    if symmetry != "general":
        cells = (cells + (-rows if symmetry == "skew-symmetric" else rows)) // 2
        if rows != columns:
            raise ValueError(f"it claims to be {symmetry}, and has {rows} rows and {columns} columns")
    width = {"complex": 2, "pattern": 0}.get(field, 1)
    claimed = (cells, width) if form == "array" else (entries, 2 + width)
    with Path(file).open("rb") as lines:
        next((line for line in lines if line.strip() and not line.lstrip().startswith(b"%")), None)
        # scipy ignores text that it does not understand.
        found = np.loadtxt(lines, comments=None, ndmin=2)
    if min(rows, columns) < 1 or (found.shape != claimed and (found.size or entries)):
        raise ValueError(f"it claims {rows} x {columns} in {claimed} numbers, and holds {found.shape}")
    # The child has no memory for threads.
    getattr(sys.modules.get("scipy.io._fast_matrix_market"), "__dict__", {})["PARALLELISM"] = 1
    return {ALONE: scipy.io.mmread(file, spmatrix=False)}


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
    """The `WANTED` arrays in a group of an HDF5 file, by default its root or `problem`."""
    image = Image(Path(file))
    allowance = Allowance(image.length - image.missing)
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
            found = {name: _from_hdf5(at, name, allowance) for name in WANTED if name in at}
            if not found:
                raise ValueError(f"none of {', '.join(WANTED)} in its group {at.name}")
            return found
    finally:
        image.close()


def _from_hdf5(group: Any, name: str, allowance: Allowance) -> Matrix:
    node = member(group, name)
    if isinstance(node, h5py.Dataset):
        return dataset(group, name, None, None, allowance)[()]
    parts = [dataset(node, part, None, (None,), allowance)[()] for part in ("data", "indices", "indptr")]
    sizes = dataset(node, "shape", None, (2,), allowance)[()] if "shape" in node else node.attrs["shape"]
    shape = tuple(int(n) for n in sizes)
    return sp.csr_array((parts[0], parts[1], parts[2]), shape=shape)


READERS: Mapping[str, Callable[[str], Mapping[str, Any]]] = {
    ".npz": _npz,
    ".json": _json,
    ".mat": partial(read_apart, _mat),
    ".h5": read_hdf5,
    ".hdf5": read_hdf5,
    ".mtx": partial(read_apart, _matrix_market),
    ".npy": _npy,
    ".txt": _text,
    ".csv": _text,
}
