"""Reads LCPs and vectors from files, with one-line errors.

Containers (.npz, .json, .h5) hold named arrays, ``A`` and ``q``; other formats one array.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Array, Matrix
from problems.lcp.data.containers import ALONE, BOUNDS, PROGRAM, READERS
from problems.lcp.data.models import MODEL_FORMATS, read_model
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.data.program import Program, from_lp, from_qp
from problems.options import finite_vector, sound_sparse

ROWS = 1 << 22
"""Most rows of a sparse matrix, or its file's bytes if more: empty rows take memory."""

CONTAINERS = (".npz", ".json", ".h5", ".hdf5")

NONE = {"lower": -math.inf, "rows_lower": -math.inf, "upper": math.inf, "h": math.inf}
"""Bounds that JSON's null stands for."""


class InputError(ValueError):
    """A file that cannot be used.

    `argument` is ``path``, or a vector's name.
    """

    def __init__(self, argument: str, complaint: str) -> None:
        self.argument = argument
        self.complaint = " ".join(complaint.split())
        super().__init__(f"{self.argument}: {self.complaint}")


def read_problem(path: str | PathLike[str], q: str | PathLike[str] | None = None) -> MixedLCP:
    """Read LCP(q, A), or a problem with bounds, from a file.

    `path` names a ``.npz``, ``.json`` or ``.h5`` file with A, q, and optionally lower, upper (JSON's null is infinite;
    HDF5: at the root or in group ``problem``); with `q` also A alone as ``.mtx``, ``.npy``, ``.txt``, ``.csv`` or
    `scipy.sparse.save_npz`. `q` is a file, preferred to a q beside A. Raises `InputError`.
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
        if any(name in contents for name in BOUNDS):
            ends: list[Any] = [None if k not in contents else _flat(_named(contents, k, "path", path)) for k in BOUNDS]
            problem = MixedLCP(A, _flat(vector), *ends)
        if problem.n == 0:
            raise ValueError("A: expected a square matrix, found shape (0, 0)")
        return problem
    except (ValueError, TypeError, OverflowError) as error:
        at_q = q is not None and str(error).startswith("q:")
        argument, file = ("q", q) if at_q else ("path", path)
        raise InputError(argument, f"{str(error).removeprefix('q: ') if at_q else error}, in {_shown(file)}") from None


def read_program(path: str | PathLike[str]) -> Program | None:
    """Read a program; None if the file holds none.

    `path` names a ``.npz``, ``.json`` or ``.h5`` with c and optional arguments of `from_qp`; or ``.qps``,
    ``.mps``, ``.lp`` (need highspy). Raises `InputError`.
    """
    if Path(path).suffix.lower() in MODEL_FORMATS and Path(path).is_file():
        try:
            return read_model(fspath(path))
        except (ValueError, ImportError) as error:
            raise InputError("path", f"{error}, in {_shown(path)}") from None
    if Path(path).suffix.lower() not in CONTAINERS:
        return None
    contents = _contents("path", path)
    if "c" not in contents or "q" in contents or "A" in contents:
        return None
    given: dict[str, Any] = {name: None for name in PROGRAM if name in contents}
    for name in given:
        given[name] = _named(contents, name, "path", path)
        if name not in ("P", "G", "A_eq"):
            given[name] = _flat(given[name])
    try:
        return from_lp(**given) if "P" not in given else from_qp(**given)
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError("path", f"{error}, in {_shown(path)}") from None


def read_matrix(path: str | PathLike[str]) -> Matrix:
    """Read A alone, unchecked; raises `InputError`."""
    return _named(_contents("path", path), "A", "path", path)


def read_vector(name: str, path: str | PathLike[str], size: int) -> Array:
    """Read `size` finite numbers; raises `InputError`."""
    value = _flat(_named(_contents(name, path), name, name, path))
    try:
        return finite_vector(name, value, size)
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(name, f"{str(error).removeprefix(f'{name}: ')}, in {_shown(path)}") from None


def _contents(argument: str, path: str | PathLike[str]) -> Mapping[str, Any]:
    file = fspath(path)
    suffix = Path(file).suffix.lower()
    if not Path(file).exists():
        raise InputError(argument, f"expected a file, found nothing at {_shown(file)}")
    if not Path(file).is_file():
        raise InputError(argument, f"expected a file, found a directory or a device at {_shown(file)}")
    if suffix not in READERS:
        known = ", ".join(READERS)
        raise InputError(argument, f"expected one of {known}, found {suffix or 'no extension'} in {_shown(file)}")
    try:
        # Claimed sizes may overflow when multiplied.
        with np.errstate(over="ignore"):
            return READERS[suffix](file)
    except Exception as error:
        reason = str(error) or type(error).__name__
        complaint = f"expected a {suffix} file, found one that cannot be read: {_shown(file)} ({reason})"
        raise InputError(argument, complaint) from None


def _named(contents: Mapping[str, Any], name: str, argument: str, path: str | PathLike[str]) -> Matrix:
    if name not in contents and ALONE not in contents:
        found = ", ".join(sorted(contents)) or "nothing"
        raise InputError(argument, f"expected an array {name}, found {found} in {_shown(path)}")
    value = contents.get(name, contents.get(ALONE))
    if isinstance(value, list) and name in NONE:
        value = [NONE[name] if entry is None else entry for entry in value]
    try:
        if sp.issparse(value):
            if max(value.shape) > max(ROWS, Path(path).stat().st_size):
                raise ValueError(f"it claims the shape {value.shape}, and is too small for that")
            return sound_sparse(name, value)
        array = np.asarray(value)
        return array.astype(float) if array.dtype == object else array
    except (ValueError, TypeError, OverflowError) as error:
        said = str(error)
        if not said.startswith(f"{name}: "):
            said = f"{name}: expected real numbers in rows of one length, found others ({error})"
        raise InputError(argument, f"{said} in {_shown(path)}") from None


def _shown(path: str | PathLike[str] | None) -> str:
    return repr(str(path))


def _flat(value: Matrix) -> Matrix:
    """A row or column as a vector."""
    array = value.toarray() if sp.issparse(value) else value
    return array.ravel() if array.ndim == 2 and 1 in array.shape else array
