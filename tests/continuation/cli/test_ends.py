"""However a command ends: one line on stderr, status 2; what a plug-in, the disk or the terminal does is said."""

import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from continuation import Budget, trace
from continuation.cli import BAD_INPUT
from problems.bifurcation import ExponentialCosine

from .util import forked

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


def process(*argv):
    """A command of its own: its status, its lines on stderr, and what it shows."""
    done = subprocess.run([sys.executable, "-m", "continuation", *argv], capture_output=True, check=False)
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
    said = run(*REFUSED[command], status=BAD_INPUT).err
    assert "Traceback" not in said
    if "leaves" in " ".join(REFUSED[command]):
        assert "SystemExit: 3" in said


@pytest.mark.parametrize("reads", [0, 7, 40, 100])
@pytest.mark.parametrize("command", WITH_ARCHIVES)
def test_a_disk_that_fails(folder, command, reads):
    """Behind so many reads."""
    before, real, left = Path("ok.h5").read_bytes(), os.pread, iter(range(reads))

    def pread(*arguments):
        if next(left, None) is None:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        return real(*arguments)

    status, said = forked(WITH_ARCHIVES[command], lambda: setattr(os, "pread", pread))
    assert (status, said.count("\n")) == (2, 1), said
    assert "Input/output error" in said
    # What the disk does not read is not what the file lacks: nothing is taken for damaged.
    assert Path("ok.h5").read_bytes() == before
    assert not Path("ok.h5.damaged").exists()


def test_a_name_that_is_no_text(folder):
    name, new = os.fsdecode(b"bad\xff.h5"), os.fsdecode(b"new\xff.csv")
    shutil.copy("ok.h5", name)
    for command in (["plot", name], ["export", name, new]):
        status, said, shown = process(*command)
        assert (status, said) == (0, [])
        assert b"\xff" in shown
    status, said, _ = process("inspect", os.fsdecode(b"none\xff.h5"))
    assert (status, len(said)) == (2, 1)


def test_stdout_that_takes_nothing(folder):
    for out in (">&-", ">/dev/full"):
        command = f"{sys.executable} -m continuation inspect ok.h5 {out}"
        said = subprocess.run(command, shell=True, capture_output=True, text=True)
        assert (said.returncode, said.stderr.count("\n")) == (2, 1)
