"""Foreign file formats, read by scipy in a child process with limits.

scipy trusts a file's sizes and types: damaged files have crashed it, made it loop, or taken all memory.
"""

from __future__ import annotations

import faulthandler
import os
import pickle
import resource
import signal
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, BinaryIO, NoReturn

from continuation.archive.hdf5 import Allowance

BYTES_A_SECOND = 1 << 22
"""Bytes a child may read per CPU second after the first two; scipy reads 20 times as many."""


def read_apart(read: Callable[[str], Mapping[str, Any]], file: str) -> Mapping[str, Any]:
    """Call `read` on the file in a child process.

    Raises `ValueError` with the child's message, or how it ended.
    """
    with TemporaryFile() as out:
        # The child takes no locks of other threads.
        with warnings.catch_warnings(action="ignore", category=DeprecationWarning):
            child = os.fork()
        if not child:
            _answer(read, file, out)
        try:
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        except BaseException:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            raise
        out.seek(0)
        if code > 0:
            raise ValueError(out.read(1000).decode(errors="replace"))
        if code < 0:
            limited = -code in (signal.SIGXCPU, signal.SIGALRM)
            raise ValueError("it takes too long to read" if limited else f"its reader ended by signal {-code}")
        found: Mapping[str, Any] = pickle.load(out)
        return found


def _answer(read: Callable[[str], Mapping[str, Any]], file: str, out: BinaryIO) -> NoReturn:
    status = 1
    try:
        # Keep crash messages off the terminal.
        faulthandler.disable()
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        size = Path(file).stat().st_size
        room, seconds = Allowance(size).limit, 2 + size // BYTES_A_SECOND
        pages = Path("/proc/self/statm")
        if pages.exists():
            here = int(pages.read_text().split()[0]) * resource.getpagesize()
            _lower(resource.RLIMIT_AS, here + 2 * room)
        _lower(resource.RLIMIT_FSIZE, room)
        _lower(resource.RLIMIT_CPU, seconds)
        _lower(resource.RLIMIT_CORE, 0)
        # Waiting for a lost lock uses no CPU time.
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(60 * seconds)
        pickle.dump(read(file), out)
        out.flush()
        status = 0
    except BaseException as error:
        out.seek(0)
        out.truncate()
        out.write((str(error) or type(error).__name__).encode(errors="replace"))
        out.flush()
    finally:
        os._exit(status)


def _lower(kind: int, value: int) -> None:
    hard = resource.getrlimit(kind)[1]
    resource.setrlimit(kind, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))
