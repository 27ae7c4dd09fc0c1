"""What others do to a file while it is written, or to one that was left: children, threads, observers, bits."""

import errno
import fcntl
import gc
from unittest.mock import Mock

import numpy as np
import pytest

from continuation import Tracer, trace
from continuation.archive import ArchiveError, open_archive, resume
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import ExponentialCosine

from .util import child, logged, observer, outcome, read

HOMOTOPY, OPTIONS = ExponentialCosine(3), {"controller": Fixed(bounds=Bounds(initial=0.05))}


@pytest.fixture(scope="module")
def path():
    return trace(HOMOTOPY, **OPTIONS)


def tracer_to(file):
    return Tracer(HOMOTOPY, observers=(logged(file),), **OPTIONS)


def ends(steps):
    """As a process ends."""


def collects(steps):
    steps.close()
    gc.collect()


def goes_on(steps):
    with pytest.raises(ArchiveError, match="it was forked from the writer"):
        list(steps)


@pytest.mark.parametrize("act", [ends, collects, goes_on])
def test_a_child_never_writes(tmp_path, path, act):
    """Forked in the middle of a path: what it closes, ends or traces is its own copy."""
    file = tmp_path / "run.h5"
    tracer = tracer_to(file)
    steps = iter(tracer)
    for step in steps:
        if step.index == 12:
            before = file.read_bytes()
            done = child(lambda: act(steps) or tracer.observers[0].close())
            assert done.status == 0, done.said
            assert file.read_bytes() == before
    with open_archive(file) as archive:
        assert archive.closed_by_writer
        assert np.array_equal(archive.path(0).u, path.u)
        assert archive.path(0).status is path.status


@pytest.mark.parametrize("where", ["step", "event", "end"])
@pytest.mark.parametrize("first", [False, True])
def test_an_observer_that_raises_leaves_a_path_to_resume(tmp_path, path, where, first):
    file = tmp_path / "run.h5"

    def raises(tracer, seen=None):
        if where != "step" or seen.index == 6:
            raise RuntimeError("of the observer")

    observers = [logged(file, 3), observer(**{where: raises})]
    with pytest.raises(RuntimeError, match="of the observer"):
        trace(HOMOTOPY, observers=observers[::-1] if first else observers, **OPTIONS)
    with open_archive(file) as archive:
        assert archive.closed_by_writer
        if where == "end":
            assert np.array_equal(archive.path(0).u, path.u)
            return
    assert np.array_equal(resume(file).u, path.u)


def test_a_log_writes_one_path_after_another(tmp_path, path):
    file = tmp_path / "run.h5"
    tracer = tracer_to(file)
    for step in tracer:
        if step.index == 7:
            with pytest.raises(ArchiveError, match="a path is being written already"):
                trace(HOMOTOPY, archive=tracer.observers[0], **OPTIONS)
    assert np.array_equal(read(file).u, path.u)


@pytest.mark.parametrize("kernel", ["Linux", "gVisor"])
def test_another_process_is_refused_whatever_locks_the_kernel_has(tmp_path, monkeypatch, kernel):
    if kernel == "gVisor":
        monkeypatch.setattr(fcntl, "fcntl", Mock(side_effect=OSError(errno.EINVAL, "Invalid argument")))
    file = tmp_path / "run.h5"
    for step in tracer_to(file):
        if step.index == 12:
            assert "is being written by another process" in child(lambda: outcome(resume, file)[0]).answer
