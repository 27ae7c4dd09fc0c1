"""What cannot be meant of the functions of archives is refused in one line that names the argument or the file."""

import os
from functools import partial

import numpy as np
import pytest

from continuation import Budget, from_functions, trace
from continuation.archive import Limits, PathLog, describe, export, merge, open_archive, recover, resume
from continuation.events import Monitor, TargetValue
from problems.bifurcation import Cusp, ExponentialCosine

from ...util import refused

CUSP, NAN = Cusp(), np.nan


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A file that has ended, one out of its budget, and some that are no archives."""
    place = tmp_path_factory.mktemp("bad")
    trace(CUSP, archive=place / "good.h5")
    trace(CUSP, archive=place / "half.h5", budget=Budget(steps=3))
    (place / "junk.h5").write_bytes(b"junk" * 100)
    (place / "empty.h5").touch()
    (place / "folder.h5").mkdir()
    os.mkfifo(place / "pipe.h5")
    (place / "link.h5").symlink_to("gone.h5")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        yield place


NO_NAMES = (None, 5, 1.5, b"good.h5", ["good.h5"])
NO_FILES = ("gone.h5", "junk.h5", "empty.h5", "folder.h5", "pipe.h5", "", "a" * 300, "no/where.h5")
NO_PLACES = ("good.h5", "folder.h5", "no/where.h5", "a" * 300, "pipe.h5", "link.h5")
READERS = {
    "open_archive": open_archive,
    "recover": recover,
    "resume": resume,
    "export": lambda file: export(file, "new.csv"),
}
WRITERS = {
    "PathLog": ("file", PathLog),
    "trace": ("archive", lambda file: trace(CUSP, archive=file)),
    "merge": ("target", lambda file: merge(["good.h5"], file)),
    "export": ("target", lambda file: export("good.h5", file)),
    "resume": ("archive", lambda file: resume("half.h5", budget=Budget(), archive=file)),
}
REFUSED = {
    **{f"{name} {value!r}": ("file", partial(call, value)) for name, call in READERS.items() for value in NO_NAMES},
    **{
        f"{name} {file!r}": (file or ".", partial(call, file))
        for name, call in {**READERS, "merge": lambda file: merge([file], "new.h5")}.items() for file in NO_FILES
    },
    # None is no archive.
    **{
        f"{name} to {value!r}": (argument, partial(call, value))
        for name, (argument, call) in WRITERS.items() for value in NO_NAMES[argument == "archive" :]
    },
    **{
        f"{name} to {file!r}": (file, partial(WRITERS[name][1], file))
        for name in ("trace", "merge", "resume") for file in NO_PLACES
    },
    "files, none": ("files", lambda: merge([], "m.h5")),
    "files, one": ("files", lambda: merge("good.h5", "m.h5")),
    "files, a number": ("files", lambda: merge(5, "m.h5")),
    "a NUL": ("a?b.h5", lambda: trace(CUSP, archive="a\0b.h5")),
    "suffix": ("target", lambda: export("good.h5", "e.txt")),
    "limits": ("limits", lambda: PathLog("l.h5", limits=(1, 2, 3))),
    **{f"rows {value!r}": ("rows", lambda value=value: Limits(rows=value)) for value in (0, -5, "a", 1.5, None)},
    **{f"seconds {value!r}": ("seconds", lambda value=value: Limits(seconds=value)) for value in (NAN, -1, "a")},
    **{
        f"keep {value!r}": ("keep", lambda value=value: PathLog("l.h5", keep=value))
        for value in ("some", "every 5", "", None, 3)
    },
    **{
        f"save_every {value!r}": ("save_every", lambda value=value: PathLog("l.h5", save_every=value))
        for value in (0, -1, 2.5, "5")
    },
    "some steps, and the ends": ("save_every", lambda: PathLog("l.h5", save_every=2, keep="ends")),
    "some steps of no file": ("save_every", lambda: trace(CUSP, save_every=2)),
    "a path described": ("archive", lambda: describe("good.h5")),
    "no budget": ("half.h5", lambda: resume("half.h5")),
    "ended": ("good.h5", lambda: resume("good.h5")),
    "a budget of 5": ("budget", lambda: resume("half.h5", budget=5)),
    "events": ("events", lambda: resume("half.h5", budget=Budget(), events=5)),
    "events, two too many": ("events", lambda: resume("half.h5", budget=Budget(), events=[TargetValue(0.3)] * 2)),
    "observers": ("observers", lambda: resume("half.h5", budget=Budget(), observers=5)),
    "a start of NaN": ("start", lambda: trace(from_functions(np.add, start=([NAN], 0.0)), archive="w.h5")),
    "start": ("start", lambda: resume("half.h5", budget=Budget(), start=(np.zeros(2), np.ones(2)))),
    "state": ("state", lambda: resume("half.h5", budget=Budget(), state=None)),
    "trust": ("trust", lambda: resume("half.h5", budget=Budget(), trust=[5])),
    "what is kept": ("keep", lambda: resume("half.h5", budget=Budget(), keep="some")),
    "another homotopy": ("homotopy", lambda: resume("half.h5", ExponentialCosine(1), budget=Budget())),
    "another size": ("homotopy", lambda: resume("half.h5", ExponentialCosine(3), budget=Budget())),
    "a class": ("homotopy", lambda: resume("half.h5", Cusp, budget=Budget())),
    "a word of no encoding": (
        "name", lambda: trace(CUSP, events=[Monitor(lambda u, v: u[0], name=5)], archive="w.h5"),
    ),
    "path 5": ("index", lambda: open_archive("good.h5").path(5)),
    "path 'a'": ("index", lambda: open_archive("good.h5").path("a")),
    "path 0.5": ("index", lambda: open_archive("good.h5")[0.5]),
    "a path that keeps some": ("keep", lambda: open_archive("good.h5").path(0, keep="some")),
    "a column": ("column", lambda: open_archive("good.h5").points["color"]),
}  # fmt: skip


@pytest.mark.parametrize(("argument", "call"), REFUSED.values(), ids=REFUSED)
def test_one_line(folder, argument, call):
    refused(argument, call)


def test_what_was_refused_has_left_nothing(folder):
    kept = {"good.h5", "half.h5", "junk.h5", "empty.h5", "folder.h5", "pipe.h5", "link.h5"}
    assert set(os.listdir(folder)) == kept
    assert len(open_archive("good.h5").path(0)) == len(trace(CUSP))
