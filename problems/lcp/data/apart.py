"""Foreign formats, read by scipy in a child process with limits: what a damaged file does there ends the child alone.

scipy's readers are compiled, and believe what a file says of its sizes and types. In this process they have been seen
to end it by SIGSEGV and SIGFPE, to loop without end, and to take all memory.
"""

from __future__ import annotations

import faulthandler
import json
import os
import resource
import signal
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, BinaryIO, NoReturn

import numpy as np
import scipy.sparse as sp

from continuation.archive.hdf5 import Allowance

BYTES_A_SECOND = 1 << 22
"""Of a file that a child reads in a second of the processor, after the first two: scipy reads 20 times as many."""

def read_apart(read: Callable[[str], Mapping[str, Any]], file: str) -> Mapping[str, Any]:
    """The arrays of a file by name, as `read` returns them; of what is no array of numbers a word for what it is.

    Raises `ValueError` with what the child says, or how it ended.
    """
    size = Path(file).stat().st_size
    with TemporaryFile() as out:
        # Python warns of other threads, whose locks stay taken in the child: it takes none of theirs, and has an end.
        with warnings.catch_warnings(action="ignore", category=DeprecationWarning):
            child = os.fork()
        if not child:
            _answer(read, file, size, out)
        ended = False
        try:
            _, status = os.waitpid(child, 0)
            ended = True
        finally:
            if not ended:
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
        code = os.waitstatus_to_exitcode(status)
        out.seek(0)
        if code > 0:
            raise ValueError(out.read(1000).decode(errors="replace"))
        if code < 0:
            limited = -code in (signal.SIGXCPU, signal.SIGALRM)
            raise ValueError("it takes too long to read" if limited else f"its reader ended by signal {-code}")
        return _taken(out)


def _answer(read: Callable[[str], Mapping[str, Any]], file: str, size: int, out: BinaryIO) -> NoReturn:
    """Read, write what was found, end: the child's whole life."""
    status = 1
    try:
        # What the child dies of is nothing for the parent's terminal.
        faulthandler.disable()
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        limit = Allowance(size).limit
        _limit(limit, 2 + size // BYTES_A_SECOND)
        _put(read(file), out, limit)
        status = 0
    except BaseException as error:
        out.seek(0)
        out.truncate()
        out.write((str(error) or type(error).__name__).encode(errors="replace"))
    finally:
        out.flush()
        os._exit(status)


def _limit(room: int, seconds: int) -> None:
    """Twice the room, for what a file holds and the arrays made of it, beyond what the process has; no core."""
    pages = Path("/proc/self/statm")
    if pages.exists():
        here = int(pages.read_text().split()[0]) * resource.getpagesize()
        _lower(resource.RLIMIT_AS, here + 2 * room)
    _lower(resource.RLIMIT_CPU, seconds)
    _lower(resource.RLIMIT_CORE, 0)
    # A lock that another thread held at the fork is never given back, and waiting for it takes no processor.
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(60 * seconds)


def _lower(kind: int, value: int) -> None:
    hard = resource.getrlimit(kind)[1]
    resource.setrlimit(kind, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))


def _put(found: Mapping[str, Any], out: BinaryIO, limit: int) -> None:
    arrays: list[Any] = []
    heads: list[list[Any]] = []
    for name, value in found.items():
        whole = value.tocoo() if sp.issparse(value) else value
        parts = [whole.data, whole.row, whole.col] if sp.issparse(value) else [value]
        sound = all(isinstance(part, np.ndarray) and part.dtype.kind in "fiubc" for part in parts)
        heads.append([name, len(parts) if sound else 0, value.shape if sound else None])
        arrays += parts if sound else []
    claimed = sum(array.nbytes for array in arrays)
    if claimed > limit:
        raise ValueError(f"it unfolds to {claimed} bytes, expected at most {limit}")
    np.savez(out, np.array(json.dumps(heads)), *arrays)


def _taken(out: BinaryIO) -> Mapping[str, Any]:
    found: dict[str, Any] = {}
    with np.load(out, allow_pickle=False) as stored:
        names = iter(stored.files)
        for name, count, shape in json.loads(str(stored[next(names)])):
            parts = [stored[next(names)] for _ in range(count)]
            if count == 3:
                found[name] = sp.coo_array((parts[0], tuple(parts[1:])), shape=tuple(shape))
            else:
                found[name] = parts[0] if parts else "no matrix of numbers"
    return found
