"""Shared by commands: file formats, and library errors as argument errors."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from continuation.cli import UsageError

PROBLEM_FORMATS = ".npz, .json, .mat or .h5 with A and q, or A alone as .mtx, .npy, .txt, .csv"


@contextmanager
def named(arguments: Mapping[str, str]) -> Iterator[None]:
    """Turn a library error about a parameter into a UsageError about the argument.

    `arguments`: parameter name, which begins the message, to typed argument. Other errors pass.
    """
    try:
        yield
    except (ValueError, TypeError, OSError) as error:
        parameter, _, complaint = str(error).partition(":")
        if parameter not in arguments:
            raise
        raise UsageError(arguments[parameter], complaint) from error


_BEGINNINGS = {b"PK": ".npz", b"\x93NUMPY": ".npy", b"\x89HDF": ".h5", b"%%MatrixMarket": ".mtx", b"MATLAB": ".mat"}
"""First bytes by format; JSON begins with a bracket."""


@contextmanager
def file_of(name: str) -> Iterator[str]:
    """The file, or for ``-`` a typed temporary copy of stdin."""
    if name != "-":
        yield name
        return
    stream = getattr(sys.stdin, "buffer", None)
    data = sys.stdin.read().encode() if stream is None else stream.read()
    kinds = (suffix for beginning, suffix in _BEGINNINGS.items() if data.startswith(beginning))
    suffix = ".json" if data.lstrip()[:1] in (b"{", b"[") else next(kinds, ".txt")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"stdin{suffix}"
        file.write_bytes(data)
        yield str(file)
