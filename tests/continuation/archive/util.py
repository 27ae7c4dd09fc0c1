"""What tests of archives have in common."""

import os
import signal
from types import SimpleNamespace

import numpy as np

from continuation import Tracer
from continuation.archive import Limits, PathLog, open_archive

from ...util import in_child


def logged(file, rows=5, **options):
    """A log that commits after so many rows, whatever the clock says."""
    return PathLog(file, limits=Limits(rows=rows, seconds=3600.0), **options)


def observer(**methods):
    """An observer with these methods, which looks at nothing else."""
    return SimpleNamespace(**{**dict.fromkeys(("step", "event", "end"), lambda *_: None), **methods})


def read(file, number=0, **options):
    """A path of an archive."""
    with open_archive(file) as archive:
        return archive.path(number, **options)


def interrupted(file, homotopy, index, rows=5, **options):
    """A trace that is given up behind a step."""
    steps = iter(Tracer(homotopy, observers=(logged(file, rows),), **options))
    next(step for step in steps if step.index == index)
    steps.close()


def killed(file, homotopy, index, rows=5, **options):
    """The file of a process that was killed at a step."""

    def work():
        for step in Tracer(homotopy, observers=(logged(file, rows),), **options):
            if step.index == index:
                os.kill(os.getpid(), signal.SIGKILL)

    assert in_child(work) == signal.SIGKILL
    return file


def assert_same(found, path):
    """Two paths, bit for bit."""
    assert np.array_equal(found.u, path.u)
    assert np.array_equal(found.arclength, path.arclength)
    steps, wanted = ([(s.index, s.kind, s.rejections) for s in one.steps] for one in (found, path))
    assert steps == wanted
    events, wanted = ([(e.name, e.step, e.monitor, *e.u) for e in one.events] for one in (found, path))
    assert events == wanted
    assert (found.status, found.message, found.counts) == (path.status, path.message, path.counts)
