"""Accidents: disks and quotas that are full, names that no file can hold, two at work on one file, links and modes."""

import json
import os
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest

from continuation import Tracer, trace
from continuation.archive import ArchiveError, Limits, PathLog, export, merge, open_archive, recover, resume
from continuation.archive.atomic import beside
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import ExponentialCosine, FreudensteinRoth

from ...util import in_child

HOMOTOPY, OPTIONS = ExponentialCosine(3), {"controller": Fixed(bounds=Bounds(initial=0.02))}


def killed(file, steps=30):
    def work():
        for step in Tracer(HOMOTOPY, observers=(PathLog(file, limits=Limits(rows=5, seconds=3600.0)),), **OPTIONS):
            if step.index == steps:
                os.kill(os.getpid(), signal.SIGKILL)

    assert in_child(work) == signal.SIGKILL
    return file


LIMITED = """
import json, os, resource, signal, sys
from continuation import trace
from continuation.archive import ArchiveError, Limits, PathLog, export, merge, recover, resume
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import ExponentialCosine
for work, file, limit, said in json.loads(sys.argv[1]):
    process = os.fork()
    if not process:
        break
    print(os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), flush=True)
else:
    sys.exit()
os.dup2(os.open(said, os.O_CREAT | os.O_WRONLY), 2)
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
try:
    if work == "trace":
        log = PathLog(file, limits=Limits(rows=20, seconds=3600.0))
        trace(ExponentialCosine(3), archive=log, controller=Fixed(bounds=Bounds(initial=0.002)))
    elif work == "merge":
        merge([file], file + ".new.h5")
    elif work == "export":
        export(file, file + ".new.nc", compression=0)
    elif work == "text":
        export(file, file + ".new.csv")
    elif work == "recover":
        recover(file)
    else:
        resume(file)
except ArchiveError as error:
    sys.exit(str(error))
"""
LEAST = {1_000: 0, 90_000: 0, 150_000: 0, 330_000: 900}
"""Of bytes that a trace may write, and the rows that are there then."""
COPIES = [(work, limit) for work in ("merge", "export", "text", "recover", "resume") for limit in (1_000, 3_000)]


@pytest.fixture(scope="module")
def limited(tmp_path_factory):
    """For each work and limit its file and what was said: processes that end as programs do, of one that imported."""
    base, told, places = killed(tmp_path_factory.mktemp("killed") / "run.h5"), tmp_path_factory.mktemp("told"), {}
    for work, limit in [*(("trace", limit) for limit in LEAST), *COPIES]:
        places[work, limit] = tmp_path_factory.mktemp(work) / "run.h5"
        if work != "trace":
            shutil.copy(base, places[work, limit])
    cases = [(*case, str(file), told / f"{k}") for k, (case, file) in enumerate(places.items())]
    argument = json.dumps([(work, file, limit, str(said)) for work, limit, file, said in cases])
    found = subprocess.run([sys.executable, "-c", LIMITED, argument], capture_output=True, text=True, check=True)
    answers = {}
    for (work, limit, _, said), status in zip(cases, map(int, found.stdout.split()), strict=True):
        text = said.read_text()
        assert status in (0, 1), f"the process ended by {status}: {text}"
        assert len(text.splitlines()) == status, text
        answers[work, limit] = places[work, limit], text.strip()
    return answers, base.read_bytes()


def rows(file):
    with open_archive(file) as archive:
        return archive.path(0).u


@pytest.fixture(scope="module")
def fine():
    return trace(HOMOTOPY, controller=Fixed(bounds=Bounds(initial=0.002)))


@pytest.mark.parametrize("limit", LEAST)
def test_a_limit_while_tracing(limited, fine, limit):
    file, complaint = limited[0]["trace", limit]
    assert complaint.startswith(f"{file}: could not be written")
    if file.exists():
        recover(file)
        with open_archive(file) as archive:
            found = archive.path(0).u if len(archive) else fine.u[:0]
        assert len(found) >= LEAST[limit]
        assert np.array_equal(found, fine.u[: len(found)])


@pytest.mark.parametrize(("work", "limit"), COPIES)
def test_a_limit_leaves_the_old_file_and_no_new_one(limited, work, limit):
    file, complaint = limited[0][work, limit]
    assert "could not be written" in complaint
    assert ".part" not in complaint
    assert os.listdir(file.parent) == ["run.h5"]
    assert file.read_bytes() == limited[1]
    assert len(rows(file)) >= 30


def test_zeros_for_what_a_limit_cut_off(tmp_path):
    """All that is committed is there; the file is shorter than it says."""
    file = killed(tmp_path / "run.h5")
    before = rows(file)
    with file.open("r+b") as raw:
        raw.truncate(file.stat().st_size - 100)
    with pytest.raises(ArchiveError, match="its last 100 bytes are missing; `recover` keeps the rows that are sound"):
        open_archive(file)
    recover(file)
    with open_archive(file) as archive:
        found = archive.path(0)
    assert len(found) >= 25
    assert np.array_equal(found.u, before[: len(found)])


class Observing:
    target = 1.0

    def __init__(self, name):
        self.name = name

    def start(self):
        return np.zeros(1), 0.0

    def residual(self, y, lam):
        return y - lam

    def observe(self, y, lam):
        return {self.name: 3.0}


@pytest.mark.parametrize("name", ["a/b", "a\0b", "", "x" * 300, "\udcff", "a\nb", " a"])
def test_names_that_no_file_can_hold_are_refused_when_tracing_begins(tmp_path, name):
    with pytest.raises(ValueError, match="observe: expected names"):
        trace(Observing(name), archive=tmp_path / "run.h5")
    assert not list(tmp_path.iterdir())


def test_a_name_that_is_no_text_is_refused_at_the_first_point(tmp_path):
    with pytest.raises(TypeError, match="observe: expected a mapping of names"):
        trace(Observing(3), archive=tmp_path / "run.h5")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", [".", "kind", "y y", "1", "\N{GREEK SMALL LETTER LAMDA}"])
def test_other_names_come_back(tmp_path, name):
    trace(Observing(name), archive=tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        assert archive.path(0).steps[1].observed == {name: 3.0}


@pytest.mark.parametrize("name", ["a\0b.h5", "x" * 250 + ".h5"])
def test_names_of_files(tmp_path, name):
    with pytest.raises(ArchiveError) as caught:
        trace(HOMOTOPY, archive=tmp_path / name)
    assert "\n" not in str(caught.value)


def test_one_writer_at_a_time(tmp_path):
    """Two resumes at once: the second is refused, whatever number its process has, and the first goes on."""
    file, path = killed(tmp_path / "run.h5"), trace(HOMOTOPY, **OPTIONS)

    class Second:
        complaints = 0

        def step(self, tracer, step):
            if step.index in (40, 60):
                for work in (resume, recover):
                    assert in_child(lambda work=work: work(file)) == 7 << 8
                    with pytest.raises(ArchiveError, match="seems to be alive"):
                        work(file)
                    self.complaints += 1

        def event(self, tracer, event):
            pass

        def end(self, tracer):
            pass

    watching = Second()
    assert np.array_equal(resume(file, observers=(watching,)).u, path.u)
    assert watching.complaints == 4
    assert np.array_equal(rows(file), path.u)


def test_a_child_does_not_keep_the_lock(tmp_path):
    """Forked while the log is open, and still there when the writer is gone."""
    file, read, write = tmp_path / "run.h5", *os.pipe()

    def work():
        steps = iter(Tracer(HOMOTOPY, observers=(PathLog(file, limits=Limits(rows=5, seconds=3600.0)),), **OPTIONS))
        for _ in range(20):
            next(steps)
        if not os.fork():
            os.close(write)
            os.read(read, 1)
            os._exit(0)
        os.kill(os.getpid(), signal.SIGKILL)

    assert in_child(work) == signal.SIGKILL
    resume(file)
    os.close(write)
    os.close(read)


def test_modes_links_and_other_files_are_left_alone(tmp_path):
    file, link = killed(tmp_path / "run.h5"), tmp_path / "link.h5"
    file.chmod(0o640)
    link.symlink_to("run.h5")
    for name in ("run.h5.part", "link.h5.part", ".run.h5.part"):
        (tmp_path / name).write_bytes(b"precious")
    recover(link)
    resume(link)
    assert link.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o640
    assert len(rows(file)) == len(trace(HOMOTOPY, **OPTIONS))
    for name in ("run.h5.part", "link.h5.part", ".run.h5.part"):
        assert (tmp_path / name).read_bytes() == b"precious"


def test_what_a_kill_left_beside_is_removed_by_the_next(tmp_path):
    target = tmp_path / "run.h5"
    left, fresh = (tmp_path / f".run.h5.0123456{k}.part" for k in range(2))
    for part in (left, fresh):
        part.write_bytes(b"half a copy")
    os.utime(left, (0, 0))
    with beside(target) as part:
        part.write_bytes(b"whole")
    assert not left.exists()
    assert fresh.exists(), "it may be another writer's, of this very second"


@pytest.mark.parametrize("work", [lambda f, t: merge([f], t), export, lambda f, t: recover(f)])
def test_a_kill_at_the_moment_of_naming(tmp_path, work):
    file, target = killed(tmp_path / "run.h5"), tmp_path / "new.h5"
    for name in ("link", "replace"):
        real = getattr(os, name)

        def die(*arguments, real=real):
            real(*arguments)
            os.kill(os.getpid(), signal.SIGKILL)

        def attempt(name=name, die=die):
            setattr(os, name, die)
            work(file, target)

        in_child(attempt)
        for found in (file, target):
            if found.exists():
                assert len(rows(found)) >= 30
        target.unlink(missing_ok=True)


def test_a_folder_that_vanishes(tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    log = PathLog(folder / "run.h5")
    folder.rmdir()
    with pytest.raises(ArchiveError, match="there is no directory"):
        trace(FreudensteinRoth(), archive=log)


def test_a_pipe_is_no_archive(tmp_path):
    os.mkfifo(tmp_path / "run.h5")
    with pytest.raises(ArchiveError, match="is no regular file"):
        open_archive(tmp_path / "run.h5")
