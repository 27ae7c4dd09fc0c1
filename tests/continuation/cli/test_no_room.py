"""Commands whose file has no room: one line, status 2, and nothing half-written under the name asked for."""

import resource

import numpy as np
import pytest

from continuation import trace
from continuation.cli import BAD_INPUT
from problems.bifurcation import ExponentialCosine

from ..archive.util import killed
from .util import forked

COMMANDS = {
    "trace": "trace exponential-cosine n=4 --archive new.h5",
    "trace, picture": "trace cusp --plot new.png",
    "chart": "chart lcp --smoke --output new",
    "merge": "merge new.h5 old.h5",
    "recover": "recover killed.h5",
    "resume": "resume killed.h5 --steps 20",
    "export": "export old.h5 new.nc",
    "export, text": "export old.h5 new.csv",
    "plot": "plot old.h5 --output new.png",
    "solve": "solve lcp.npz --homotopy kkt --archive new.h5",
    "solve, picture": "solve lcp.npz --plot new.png",
}


@pytest.mark.parametrize("command", COMMANDS)
def test_one_line(tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    trace(ExponentialCosine(4), archive=tmp_path / "old.h5")
    killed(tmp_path / "killed.h5", ExponentialCosine(4), 9, 5)
    np.savez(tmp_path / "lcp.npz", A=[[2.0, 1.0], [1.0, 2.0]], q=[-5.0, -6.0])
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    status, said = forked(COMMANDS[command].split(), lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1500, 1500)))
    assert status == BAD_INPUT, said
    assert said.startswith("continuation: ")
    assert said.count("\n") == 1, said
    assert "File too large" in said
    left = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert left == before
