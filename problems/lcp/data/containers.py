"""Readers of files that hold arrays."""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Callable, Mapping
from contextlib import closing
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.sparse as sp

from continuation.archive.hdf5 import Allowance, Image, dataset, member, subgroup
from continuation.arrays import Matrix
from problems.lcp.data import matlab
from problems.lcp.data.models import read_model

ALONE = ""
"""Name of an unnamed array."""

BOUNDS = ("lower", "upper")

PROGRAM = ("P", "c", "G", "h", "A_eq", "b_eq", *BOUNDS, "rows_lower")
WANTED = ("A", "q", "x0", *PROGRAM)


def _numpy(file: str, allowance: Allowance) -> Mapping[str, Any]:
    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            allowance.take("it", sum(part.file_size for part in archive.infolist()))
    # A memory map takes no more than the file.
    stored = np.load(file, mmap_mode="r", allow_pickle=False)
    if not isinstance(stored, np.lib.npyio.NpzFile):
        return {ALONE: np.array(stored)}
    with stored:
        if {"format", "shape", "data"} <= set(stored.files):
            return {ALONE: sp.load_npz(file)}
        return {name: stored[name] for name in stored.files}


def _json(file: str, allowance: Allowance) -> Mapping[str, Any]:
    value = json.loads(Path(file).read_text(encoding="utf-8"), object_pairs_hook=_named_once)
    return value if isinstance(value, dict) else {ALONE: value}


def _named_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    named = dict(pairs)
    if len(named) < len(pairs):
        raise ValueError("it names something twice")
    return named


def _matrix_market(file: str, allowance: Allowance) -> Mapping[str, Any]:
    with Path(file).open(encoding="ascii") as lines:
        form, field, symmetry = [*next(lines, "").lower().split(), *5 * [""]][2:5]
        told = (line for line in lines if line.strip() and not line.lstrip().startswith("%"))
        rows, columns, *entries = (int(word) for word in next(told, "0 0").split())
        words = " ".join(told).split()
    if (form, field, symmetry) not in product(("array", "coordinate"), ("real", "integer"), ("general", "symmetric")):
        raise ValueError("expected a real matrix, general or symmetric")
    symmetric = symmetry == "symmetric"
    cells = 3 * sum(entries) if form == "coordinate" else rows * (rows + 1) // 2 if symmetric else rows * columns
    if min(rows, columns) < 1 or (symmetric and rows != columns) or len(words) != cells:
        raise ValueError(f"it claims {rows} x {columns}, {symmetry}, in {cells} numbers, and holds {len(words)}")
    if form == "coordinate":
        i, j = (np.array([int(word) for word in words[k::3]], dtype=np.int64) - 1 for k in (0, 1))
        value = np.array(words[2::3], dtype=float)
    else:
        j, i = np.triu_indices(rows) if symmetric else np.indices((columns, rows)).reshape(2, -1)
        value = np.array(words, dtype=float)
    off = (i != j) & symmetric
    parts = np.append(value, value[off]), (np.append(i, j[off]), np.append(j, i[off]))
    stored = sp.coo_array(parts, shape=(rows, columns))
    return {ALONE: stored if form == "coordinate" else stored.toarray()}


def _text(file: str, allowance: Allowance) -> Mapping[str, Any]:
    lines = [line.split("#")[0] for line in Path(file).read_text(encoding="utf-8").splitlines()]
    for k, line in enumerate(lines, 1):
        if re.search(r"^\s*,|,\s*,", line):
            raise ValueError(f"line {k} has an empty cell")
    numbers = [[float(number) for number in line.replace(",", " ").split()] for line in lines if line.strip()]
    if not numbers:
        raise ValueError("it is empty")
    return {ALONE: np.array(numbers)}


def _hdf5(file: str, allowance: Allowance) -> Mapping[str, Any]:
    """The `WANTED` arrays at the root of an HDF5 file, or in its group `problem`."""
    with closing(Image(Path(file))) as image, h5py.File(image, "r") as root:
        at = subgroup(root, "problem") if "problem" in root and "A" not in root else root
        found = {name: _from_hdf5(at, name, allowance) for name in WANTED if name in at}
        if not found:
            raise ValueError(f"none of {', '.join(WANTED)} in its group {at.name}")
        return found


def _from_hdf5(group: Any, name: str, allowance: Allowance) -> Matrix:
    node = member(group, name)
    if isinstance(node, h5py.Dataset):
        return dataset(group, name, None, None, allowance)[()]
    parts = tuple(dataset(node, part, None, (None,), allowance)[()] for part in ("data", "indices", "indptr"))
    sizes = dataset(node, "shape", None, (2,), allowance)[()] if "shape" in node else node.attrs["shape"]
    return sp.csr_array(parts, shape=tuple(int(n) for n in sizes))


READERS: Mapping[str, Callable[[str, Allowance], Mapping[str, Any]]] = {
    ".npz": _numpy,
    ".json": _json,
    ".mat": lambda file, allowance: matlab.read(file, allowance.limit),
    ".h5": _hdf5,
    ".hdf5": _hdf5,
    ".mtx": _matrix_market,
    ".npy": _numpy,
    ".txt": _text,
    ".csv": _text,
    ".qps": read_model,
    ".mps": read_model,
    ".lp": read_model,
}
