"""MAT-files, read by scipy in a child process with limits: damaged ones have crashed it, or made it loop."""

from __future__ import annotations

import pickle
import resource
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

BYTES_A_SECOND = 1 << 22
"""Bytes that a child may read per CPU second after the first five; scipy reads 20 times as many."""


def read(file: str, most: int) -> Mapping[str, Any]:
    """The arrays of a MAT-file by name, of at most so many bytes; ValueError if it cannot be read."""
    seconds = 5 + Path(file).stat().st_size // BYTES_A_SECOND
    with TemporaryFile() as out:
        command = [sys.executable, __file__, file, str(most), str(seconds)]
        ran = subprocess.run(command, stdout=out, stderr=subprocess.PIPE, text=True)
        if ran.returncode:
            said = ran.stderr.strip().splitlines()[-1:] if ran.returncode > 0 else []
            raise ValueError(said[0] if said else "its reader crashed, or took too much time or memory")
        out.seek(0)
        found: Mapping[str, Any] = pickle.load(out)
        return found


def main() -> None:
    """Write the arrays of the file in the command line to standard output."""
    import scipy.io

    file, most, seconds = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    pages = Path("/proc/self/statm")
    if pages.exists():
        here = int(pages.read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (here + 2 * most, here + 2 * most))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    held = scipy.io.loadmat(file, spmatrix=False)
    pickle.dump({name: value for name, value in held.items() if not name.startswith("__")}, sys.stdout.buffer)


if __name__ == "__main__":
    main()
