"""Commands whose file has no room: one line, status 2, and nothing half-written under the name asked for."""

import os
import resource

import numpy as np
import pytest

from continuation import trace
from continuation.cli import BAD_INPUT, main
from problems.bifurcation import ExponentialCosine

COMMANDS = {
    "trace": "trace exponential-cosine n=4 --archive new.h5",
    "trace, picture": "trace cusp --plot new.png",
    "chart": "chart lcp --smoke --output new",
    "merge": "merge new.h5 old.h5",
    "export": "export old.h5 new.nc",
    "export, text": "export old.h5 new.csv",
    "plot": "plot old.h5 --output new.png",
    "solve": "solve lcp.npz --homotopy kkt --archive new.h5",
    "solve, picture": "solve lcp.npz --plot new.png",
}


@pytest.mark.parametrize("command", COMMANDS)
def test_one_line(tmp_path, command):
    trace(ExponentialCosine(4), archive=tmp_path / "old.h5")
    np.savez(tmp_path / "lcp.npz", A=[[2.0, 1.0], [1.0, 2.0]], q=[-5.0, -6.0])
    old = (tmp_path / "old.h5").read_bytes()
    status, said = limited(tmp_path, COMMANDS[command].split())
    assert status == BAD_INPUT, said
    assert said.startswith("continuation: ")
    assert said.count("\n") == 1, said
    assert "File too large" in said
    left = {path.name for path in tmp_path.iterdir()} - {"new"}
    assert left == {"old.h5", "lcp.npz", "said"}
    assert (tmp_path / "old.h5").read_bytes() == old


def limited(folder, words):
    """The status of a command in a process whose files may have 1,500 bytes, and what it says."""
    process = os.fork()
    if not process:
        status = 99
        try:
            os.chdir(folder)
            os.dup2(os.open("said", os.O_WRONLY | os.O_CREAT), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            resource.setrlimit(resource.RLIMIT_FSIZE, (1500, resource.RLIM_INFINITY))
            with open(2, "w", closefd=False) as stderr, pytest.MonkeyPatch.context() as patch:
                patch.setattr("sys.stderr", stderr)
                status = main(words)
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), (folder / "said").read_text()
