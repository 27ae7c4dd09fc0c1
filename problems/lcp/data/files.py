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
from problems.lcp.data.models import MODEL_FORMATS, read_model
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.data.program import Program, from_lp, from_qp
from problems.options import finite_vector, real_array, sound_sparse

CONTAINERS = (".npz", ".json", ".mat", ".h5", ".hdf5")

NONE = {"lower": -math.inf, "rows_lower": -math.inf, "upper": math.inf, "h": math.inf}
"""Bounds for which JSON's null stands."""


class InputError(ValueError):
    """An unusable file; `argument` is ``path``, or a vector's name."""

    def __init__(self, argument: str, complaint: str) -> None:
        self.argument = argument
        self.complaint = " ".join(complaint.split())
        super().__init__(f"{self.argument}: {self.complaint}")


def read_problem(path: str | PathLike[str], q: str | PathLike[str] | None = None) -> MixedLCP:
    """Read LCP(q, A), or a problem with bounds, from a file.

    `path` names a ``.npz``, ``.json``, ``.mat`` (before 7.3) or ``.h5`` file with A, q, and optionally lower, upper
    (JSON's null is infinite; HDF5: at the root or in group ``problem``); with `q` also A alone as ``.mtx``, ``.npy``,
    ``.txt``, ``.csv`` or `scipy.sparse.save_npz`. `q` is a file, preferred to a q beside A. Raises `InputError`.
    """
    contents = _contents("path", path)
    if q is None and ALONE in contents:
        raise InputError("path", f"expected A and q, found one array in {str(path)!r}; give q in its own file")
    with _in_files(path=path, **({} if q is None else {"q": q})):
        A, of_q = _named(contents, "A", path), (contents, "q", path) if q is None else (_contents("q", q), "q", q)
        given = {name: _flat(_named(contents, name, path)) for name in BOUNDS if name in contents}
        vector = _flat(_named(*of_q))
        problem: MixedLCP = MixedLCP(A, vector, **given) if given else LCP(A, vector)
        if problem.n == 0:
            raise ValueError("A: expected a square matrix, found shape (0, 0)")
    return problem


def read_program(path: str | PathLike[str]) -> Program | None:
    """Read a program; None if the file holds none.

    `path` names a ``.npz``, ``.json``, ``.mat`` or ``.h5`` with c and optional arguments of `from_qp`; or ``.qps``,
    ``.mps``, ``.lp`` (need highspy). Raises `InputError`.
    """
    suffix = Path(path).suffix.lower()
    with _in_files(path=path):
        if suffix in MODEL_FORMATS and Path(path).is_file():
            return read_model(fspath(path))
        contents = _contents("path", path) if suffix in CONTAINERS else {}
        if "c" not in contents or "q" in contents or "A" in contents:
            return None
        given = {name: _named(contents, name, path) for name in PROGRAM if name in contents}
        given = {name: value if name in ("P", "G", "A_eq") else _flat(value) for name, value in given.items()}
        return from_lp(**given) if "P" not in given else from_qp(**given)


def read_matrix(path: str | PathLike[str]) -> Matrix:
    """Read A alone, unchecked; raises `InputError`."""
    with _in_files(path=path):
        return _named(_contents("path", path), "A", path)


def read_vector(name: str, path: str | PathLike[str], size: int) -> Array:
    """Read `size` finite numbers; raises `InputError`."""
    with _in_files(**{name: path}):
        return finite_vector(name, _flat(_named(_contents(name, path), name, path)), size)


@contextmanager
def _in_files(**files: str | PathLike[str]) -> Iterator[None]:
    """Turn errors into `InputError` of the argument that they name, else of the first."""
    try:
        yield
    except InputError:
        raise
    except (ValueError, TypeError, OverflowError, ImportError) as error:
        named = str(error).partition(":")[0]
        argument = named if named in files else next(iter(files))
        said = str(error).removeprefix(f"{argument}: ")
        raise InputError(argument, f"{said}, in {str(files[argument])!r}") from None


def _contents(argument: str, path: str | PathLike[str]) -> Mapping[str, Any]:
    file = fspath(path)
    suffix = Path(file).suffix.lower()
    if not Path(file).exists():
        raise InputError(argument, f"expected a file, found nothing at {file!r}")
    if not Path(file).is_file():
        raise InputError(argument, f"expected a file, found a directory or a device at {file!r}")
    if suffix not in READERS:
        known = ", ".join(READERS)
        raise InputError(argument, f"expected one of {known}, found {suffix or 'no extension'} in {file!r}")
    try:
        # Claimed sizes may overflow when multiplied.
        with np.errstate(over="ignore"):
            return READERS[suffix](file)
    except Exception as error:
        reason = str(error) or type(error).__name__
        complaint = f"expected a {suffix} file, found one that cannot be read: {file!r} ({reason})"
        raise InputError(argument, complaint) from None


def _named(contents: Mapping[str, Any], name: str, path: str | PathLike[str]) -> Matrix:
    if name not in contents and ALONE not in contents:
        raise ValueError(f"expected an array {name}, found {', '.join(sorted(contents)) or 'nothing'}")
    value = contents.get(name, contents.get(ALONE))
    if isinstance(value, list) and name in NONE:
        value = [NONE[name] if entry is None else entry for entry in value]
    if not sp.issparse(value):
        return real_array(name, value)
    # Empty rows take memory.
    Allowance(Path(path).stat().st_size).take(f"its shape {value.shape}", 8 * max(value.shape))
    return sound_sparse(name, value)


def _flat(value: Matrix) -> Matrix:
    array = value.toarray() if sp.issparse(value) else value
    return array.ravel() if array.ndim == 2 and 1 in array.shape else array
