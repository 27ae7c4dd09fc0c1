"""What tests of archives have in common."""

from types import SimpleNamespace

import numpy as np
from matplotlib.figure import Figure

from continuation import Budget, Tracer
from continuation.archive import (
    ArchiveError,
    Limits,
    PathLog,
    describe,
    export,
    merge,
    open_archive,
    recover,
    resume,
)

from ...util import benchmark

child, killed = (getattr(benchmark("archive_kills.py"), name) for name in ("child", "left_by_a_kill"))

OPERATIONS = {
    "open": lambda file: repr(open_archive(file)),
    "read": lambda file: [path.u for path in open_archive(file)],
    "columns": lambda file: dict(open_archive(file).points),
    "problem": lambda file: open_archive(file).contents.problem(),
    "checkpoint": lambda file: open_archive(file).checkpoint(),
    "describe": lambda file: describe(open_archive(file)),
    "table": lambda file: open_archive(file)._repr_html_(),
    "xarray": lambda file: open_archive(file).to_xarray(),
    "picture": lambda file: (
        open_archive(file).path(0).plot(Figure().subplots()).figure.savefig(file.with_suffix(".png"))
    ),
    "export": lambda file: export(file, file.with_suffix(".csv")),
    "merge": lambda file: merge([file], file.with_suffix(".nc")),
    "recover": recover,
    "resume": lambda file: resume(file, archive=file.with_suffix(".more.h5"), budget=Budget(steps=14)),
}


def outcome(operation, file):
    """What is said of an archive, and what is found in it."""
    try:
        return "", operation(file)
    except ArchiveError as error:
        return str(error), None


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


def assert_same(found, path):
    """Two paths, bit for bit."""
    assert np.array_equal(found.u, path.u)
    assert np.array_equal(found.arclength, path.arclength)
    steps, wanted = ([(s.index, s.kind, s.rejections) for s in one.steps] for one in (found, path))
    assert steps == wanted
    events, wanted = ([(e.name, e.step, e.monitor, *e.u) for e in one.events] for one in (found, path))
    assert events == wanted
    assert (found.status, found.message, found.counts) == (path.status, path.message, path.counts)
