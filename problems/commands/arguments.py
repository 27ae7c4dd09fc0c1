"""Shared by commands: files of problems."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PROBLEM_FORMATS = ".npz, .json, .mat or .h5 with A and q, or A alone as .mtx, .npy, .txt, .csv"


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
