"""However a command ends: one line on stderr, status 2; what a plug-in, the disk or the terminal does is said."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from continuation import Budget, trace
from problems.bifurcation import ExponentialCosine

PLUGINS = {
    "number": "class H:\n    def start(self): return 0\n    def residual(self, y, lam): return y\n",
    "leaves": "import sys\nsys.exit(3)\n",
    "leaves_later": (
        "import sys\nimport numpy as np\nclass H:\n    def start(self): return np.zeros(1), 0.0\n"
        "    def residual(self, y, lam):\n        if lam > 0.1: sys.exit(3)\n        return y - lam\n"
    ),
    "generator": (
        "import numpy as np\nclass H:\n    def start(self): return np.zeros(1), 0.0\n"
        "    def residual(self, y, lam):\n        if lam > 0.1: raise GeneratorExit\n        return y - lam\n"
    ),
}
FAILING = """
import errno, os, sys
left, real = int(sys.argv[1]), os.preadv
def preadv(*arguments):
    global left
    left -= 1
    if left < 0:
        raise OSError(errno.EIO, os.strerror(errno.EIO))
    return real(*arguments)
os.preadv = preadv
from continuation.cli import main
sys.exit(main(sys.argv[2:]))
"""
WITH_ARCHIVES = {
    "inspect": ["inspect", "ok.h5"],
    "plot": ["plot", "ok.h5"],
    "export": ["export", "ok.h5", "new.csv"],
    "merge": ["merge", "new.h5", "ok.h5"],
    "recover": ["recover", "ok.h5"],
    "recheck": ["recheck", "ok.h5"],
    "resume": ["resume", "ok.h5", "--steps", "20", "--archive", "new.h5"],
}


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    file = tmp_path_factory.mktemp("archive") / "ok.h5"
    trace(ExponentialCosine(4), archive=file, budget=Budget(steps=9))
    return file


@pytest.fixture(autouse=True)
def folder(tmp_path, archive, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(archive, "ok.h5")
    for name, text in PLUGINS.items():
        (tmp_path / f"{name}.py").write_text(text)
    return tmp_path


def process(*argv, code=None):
    """A command of its own: its status, and its lines on stderr."""
    start = ["-m", "continuation"] if code is None else ["-c", code]
    path = os.pathsep.join(filter(None, (os.path.dirname(os.path.dirname(shutil.__file__)), *sys.path)))
    done = subprocess.run(
        [sys.executable, *start, *argv], capture_output=True, env={**os.environ, "PYTHONPATH": path}, check=False
    )
    return done.returncode, done.stderr.decode(errors="surrogateescape").splitlines(), done.stdout


REFUSED = {
    "a module": ["resume", "ok.h5", "--steps", "5", "--trust", "os:path"],
    "what has no name": ["resume", "ok.h5", "--steps", "5", "--trust", "builtins:exit"],
    "a module that leaves": ["resume", "ok.h5", "--steps", "5", "--trust", "leaves:H"],
    "another start": ["resume", "ok.h5", "--steps", "5", "--homotopy", "number:H"],
    "no parameters": ["trace", "builtins:type"],
    "none to check": ["check", "builtins:type"],
    "a plug-in that leaves": ["trace", "leaves:H"],
    "one that leaves later": ["trace", "leaves_later:H"],
    "a generator's end": ["trace", "generator:H"],
    "a file that cannot be read": ["inspect", "/proc/self/mem"],
}


@pytest.mark.parametrize("command", REFUSED)
def test_one_line(run, command):
    status, _, said = run(*REFUSED[command])
    assert status == 2
    assert "Traceback" not in said
    if "leaves" in " ".join(REFUSED[command]):
        assert "SystemExit: 3" in said


@pytest.mark.parametrize("command", WITH_ARCHIVES)
def test_a_disk_that_fails(command):
    before = Path("ok.h5").read_bytes()
    for left in (0, 7, 40, 100):
        status, said, _ = process(str(left), *WITH_ARCHIVES[command], code=FAILING)
        assert (status, len(said)) == (2, 1), said
        assert "Input/output error" in said[0]
    # What the disk does not read is not what the file lacks: nothing is taken for damaged.
    assert Path("ok.h5").read_bytes() == before
    assert not Path("ok.h5.damaged").exists()


def test_a_name_that_is_no_text(folder):
    name = os.fsdecode(b"bad\xff.h5")
    shutil.copy("ok.h5", name)
    new = os.fsdecode(b"new\xff.csv")
    for command in (["inspect", name], ["plot", name], ["export", name, new], ["recover", name]):
        status, said, shown = process(*command)
        assert (status, said) == (0, [])
        assert b"\xff" in shown or command[0] == "inspect"
    status, said, _ = process("inspect", os.fsdecode(b"none\xff.h5"))
    assert (status, len(said)) == (2, 1)


def test_stdout_that_takes_nothing(folder):
    for out in (">&-", ">/dev/full"):
        command = f"{sys.executable} -m continuation inspect ok.h5 {out}"
        said = subprocess.run(command, shell=True, capture_output=True, text=True)
        assert (said.returncode, said.stderr.count("\n")) == (2, 1)
