"""Readers of files that hold arrays."""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.sparse as sp

from continuation.archive.hdf5 import Allowance, Image, dataset, member, subgroup
from continuation.arrays import Matrix
from problems.lcp.data import matlab

ALONE = ""
"""Name of an unnamed array."""

BOUNDS = ("lower", "upper")

PROGRAM = ("P", "c", "G", "h", "A_eq", "b_eq", *BOUNDS, "rows_lower")
WANTED = ("A", "q", "x0", *PROGRAM)


def _numpy(file: str) -> Mapping[str, Any]:
    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            unfolded = sum(part.file_size for part in archive.infolist())
        Allowance(Path(file).stat().st_size).take("it", unfolded)
    # A memory map takes no more than the file.
    stored = np.load(file, mmap_mode="r", allow_pickle=False)
    if not isinstance(stored, np.lib.npyio.NpzFile):
        return {ALONE: np.array(stored)}
    with stored:
        if {"format", "shape", "data"} <= set(stored.files):
            return {ALONE: sp.load_npz(file)}
        return {name: stored[name] for name in stored.files}


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


def _matrix_market(file: str) -> Mapping[str, Any]:
    with Path(file).open(encoding="ascii") as lines:
        form, field, symmetry = [*next(lines, "").lower().split(), *5 * [""]][2:5]
        told = (line for line in lines if line.strip() and not line.lstrip().startswith("%"))
        rows, columns, *entries = (int(word) for word in next(told, "0 0").split())
        numbers = np.array(" ".join(told).split(), dtype=float)
    known = ("array", "coordinate"), ("real", "integer"), ("general", "symmetric")
    if not all(word in words for word, words in zip((form, field, symmetry), known)):
        raise ValueError("expected a real matrix, general or symmetric")
    symmetric = symmetry == "symmetric"
    cells = 3 * sum(entries) if form == "coordinate" else rows * (rows + 1) // 2 if symmetric else rows * columns
    if min(rows, columns) < 1 or (symmetric and rows != columns) or numbers.size != cells:
        raise ValueError(f"it claims {rows} x {columns}, {symmetry}, in {cells} numbers, and holds {numbers.size}")
    if form == "array" and not symmetric:
        return {ALONE: numbers.reshape(columns, rows).T}
    if form == "array":
        j, i, value = *np.triu_indices(rows), numbers
    else:
        i, j, value = numbers.reshape(-1, 3).T - [[1.0], [1.0], [0.0]]
        if (i % 1.0).any() or (j % 1.0).any():
            raise ValueError("expected whole numbers for rows and columns")
        i, j = i.astype(np.int64), j.astype(np.int64)
    off = (i != j) & symmetric
    parts = np.append(value, value[off]), (np.append(i, j[off]), np.append(j, i[off]))
    stored = sp.coo_array(parts, shape=(rows, columns))
    return {ALONE: stored if form == "coordinate" else stored.toarray()}


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


def _mat(file: str) -> Mapping[str, Any]:
    return matlab.read(file, Allowance(Path(file).stat().st_size).limit)


def _hdf5(file: str) -> Mapping[str, Any]:
    image = Image(Path(file))
    allowance = Allowance(image.length - image.missing)
    try:
        with h5py.File(image, "r") as root:
            at = subgroup(root, "problem") if "problem" in root and "A" not in root else root
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
    ".npz": _numpy,
    ".json": _json,
    ".mat": _mat,
    ".h5": _hdf5,
    ".hdf5": _hdf5,
    ".mtx": _matrix_market,
    ".npy": _numpy,
    ".txt": _text,
    ".csv": _text,
}
