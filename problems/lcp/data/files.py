"""Reads LCPs and vectors from files, with one-line errors.

Containers (.npz, .json, .mat, .h5) hold named arrays, ``A`` and ``q``; other formats hold one array.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from continuation.archive.hdf5 import Allowance
from continuation.arrays import Array, Matrix
from problems.lcp.data.containers import ALONE, BOUNDS, PROGRAM, READERS
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.data.program import Program, from_lp, from_qp
from problems.options import finite_vector, real_array, sound_sparse

MATRICES = ("A", "P", "G", "A_eq")

NONE = {"lower": -math.inf, "rows_lower": -math.inf, "upper": math.inf, "h": math.inf}
"""Bounds for which JSON's null stands."""


class InputError(ValueError):
    """An unusable file; `argument` is ``path``, or a vector's name."""

    def __init__(self, argument: str, complaint: str) -> None:
        self.argument = argument
        super().__init__(f"{argument}: {' '.join(complaint.split())}")


def read_problem(path: str | PathLike[str], q: str | PathLike[str] | None = None) -> MixedLCP | Program:
    """Read LCP(q, A), a problem with bounds, or a program, from a file.

    `path` names a ``.npz``, ``.json``, ``.mat`` (before 7.3) or ``.h5`` file with A, q, and optionally lower, upper
    (JSON's null is infinite; HDF5: at the root or in group ``problem``), or with c and optional arguments of `from_qp`;
    or ``.qps``, ``.mps``, ``.lp`` (need highspy); with `q` also A alone as ``.mtx``, ``.npy``, ``.txt``, ``.csv`` or
    `scipy.sparse.save_npz`. `q` is a file, preferred to a q beside A. Raises `InputError`.
    """
    with _in_files(path=path, **({} if q is None else {"q": q})):
        contents = _contents("path", path)
        if q is None and ALONE in contents:
            raise ValueError(f"expected A and q, found one array in {fspath(path)!r}; give q in its own file")
        if q is None and "c" in contents and not {"A", "q"} & set(contents):
            program = {name: _named(contents, name) for name in PROGRAM if name in contents}
            return from_qp(**program) if "P" in program else from_lp(**program)
        A = _named(contents, "A")
        vector = _named(contents if q is None else _contents("q", q), "q")
        given = {name: _named(contents, name) for name in BOUNDS if name in contents}
        problem: MixedLCP = MixedLCP(A, vector, **given) if given else LCP(A, vector)
        if problem.n == 0:
            raise ValueError("A: expected a square matrix, found shape (0, 0)")
    return problem


def read_matrix(path: str | PathLike[str]) -> Matrix:
    """Read A alone, unchecked; raises `InputError`."""
    with _in_files(path=path):
        return _named(_contents("path", path), "A")


def read_vector(name: str, path: str | PathLike[str], size: int) -> Array:
    """Read `size` finite numbers; raises `InputError`."""
    with _in_files(**{name: path}):
        return finite_vector(name, _named(_contents(name, path), name), size)


@contextmanager
def _in_files(**files: str | PathLike[str]) -> Iterator[None]:
    """Turn errors into `InputError` of the argument that they name, else of the first."""
    try:
        yield
    except (ValueError, TypeError, OverflowError) as error:
        named = str(error).partition(":")[0]
        argument = named if named in files else next(iter(files))
        said, file = str(error).removeprefix(f"{argument}: "), repr(fspath(files[argument]))
        raise InputError(argument, said if file in said else f"{said}, in {file}") from None


def _contents(argument: str, path: str | PathLike[str]) -> Mapping[str, Any]:
    file = fspath(path)
    suffix = Path(file).suffix.lower() or "no extension"
    if not Path(file).is_file():
        found = "a directory or a device" if Path(file).exists() else "nothing"
        raise ValueError(f"{argument}: expected a file, found {found} at {file!r}")
    if suffix not in READERS:
        raise ValueError(f"{argument}: expected one of {', '.join(READERS)}, found {suffix} in {file!r}")
    allowance = Allowance(Path(file).stat().st_size)
    try:
        # Claimed sizes may overflow when multiplied.
        with np.errstate(over="ignore"):
            arrays = READERS[suffix](file, allowance)
        for value in filter(sp.issparse, arrays.values()):
            # Empty rows take memory.
            allowance.take(f"its shape {value.shape}", 8 * max(value.shape))
    except Exception as error:
        reason = str(error) or type(error).__name__
        said = f"{argument}: expected a {suffix} file, found one that cannot be read: {file!r} ({reason})"
        raise ValueError(said) from None
    return arrays


def _named(contents: Mapping[str, Any], name: str) -> Matrix:
    """A matrix, or a vector, perhaps stored as a row or column."""
    if name not in contents and ALONE not in contents:
        raise ValueError(f"expected an array {name}, found {', '.join(sorted(contents)) or 'nothing'}")
    value = contents.get(name, contents.get(ALONE))
    if isinstance(value, list) and name in NONE:
        value = [NONE[name] if entry is None else entry for entry in value]
    array: Matrix = sound_sparse(name, value) if sp.issparse(value) else real_array(name, value)
    if name in MATRICES or array.ndim != 2 or 1 not in array.shape:
        return array
    return (array.toarray() if sp.issparse(array) else array).ravel()
