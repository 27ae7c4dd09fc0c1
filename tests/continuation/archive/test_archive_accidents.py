"""Accidents: quotas that are full, names that no file can hold, two at work on one file, links and modes."""

import os
import signal

import pytest

from continuation import Tracer, trace
from continuation.archive import ArchiveError, export, merge, recover, resume
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import ExponentialCosine, FreudensteinRoth

from ...util import refused
from .util import child, killed, logged, read

HOMOTOPY, OPTIONS = ExponentialCosine(3), {"controller": Fixed(bounds=Bounds(initial=0.02))}


@pytest.fixture
def file(tmp_path):
    return killed(tmp_path / "run.h5", HOMOTOPY, 30, 5, **OPTIONS)


def observing(name):
    """A homotopy with an observed scalar of this name."""
    return type("Observing", (FreudensteinRoth,), {"observe": lambda self, y, lam: {name: 3.0}})()


@pytest.mark.parametrize("name", ["a/b", "a\0b", "", "x" * 300, "\udcff", "a\nb", " a", 3])
def test_names_that_no_file_can_hold_are_refused(tmp_path, name):
    refused("observe", lambda: trace(observing(name), archive=tmp_path / "run.h5"))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", [".", "kind", "y y", "1", "\N{GREEK SMALL LETTER LAMDA}"])
def test_other_names_come_back(tmp_path, name):
    trace(observing(name), archive=tmp_path / "run.h5")
    assert read(tmp_path / "run.h5").steps[1].observed == {name: 3.0}


def test_a_child_does_not_keep_the_lock(tmp_path):
    """Forked while the log is open, and still there when the writer is gone."""
    file, reads, writes = tmp_path / "run.h5", *os.pipe()

    def work():
        steps = iter(Tracer(HOMOTOPY, observers=(logged(file),), **OPTIONS))
        next(step for step in steps if step.index == 20)
        if not os.fork():
            os.close(writes)
            os.read(reads, 1)
            os._exit(0)
        os.kill(os.getpid(), signal.SIGKILL)

    assert child(work).status == signal.SIGKILL
    resume(file)
    os.close(writes)
    os.close(reads)


def test_modes_links_and_other_files_are_left_alone(tmp_path, file):
    link, others = tmp_path / "link.h5", [tmp_path / f"{name}.part" for name in ("run.h5", "link.h5", ".run.h5")]
    file.chmod(0o640)
    link.symlink_to("run.h5")
    for name in others:
        name.write_bytes(b"precious")
    recover(link)
    resume(link)
    assert link.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o640
    assert len(read(file)) == len(trace(HOMOTOPY, **OPTIONS))
    assert {name.read_bytes() for name in others} == {b"precious"}


@pytest.mark.parametrize(
    ("name", "work"),
    [("link", lambda f, t: merge([f], t)), ("link", export), ("replace", lambda f, t: recover(f))],
    ids=["merge", "export", "recover"],
)
def test_a_kill_at_the_moment_of_naming(tmp_path, file, name, work):
    target, real = tmp_path / "new.h5", getattr(os, name)

    def attempt():
        setattr(os, name, lambda *arguments: (real(*arguments), os.kill(os.getpid(), signal.SIGKILL)))
        work(file, target)

    assert child(attempt).status == signal.SIGKILL
    assert target.exists() == (name == "link")
    assert all(len(read(found)) >= 30 for found in (file, target) if found.exists())


def test_a_folder_that_vanishes(tmp_path):
    (tmp_path / "folder").mkdir()
    log = logged(tmp_path / "folder" / "run.h5")
    (tmp_path / "folder").rmdir()
    with pytest.raises(ArchiveError, match="there is no directory"):
        trace(FreudensteinRoth(), archive=log)
