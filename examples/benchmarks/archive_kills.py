"""Kills by the thousand: committed rows stay, and a file under its final name is whole.

    python examples/benchmarks/archive_kills.py [NUMBER] [SEED] [WORK ...]

NUMBER processes at each work (trace, resume, recover, merge, export, sweep, pool), each killed at a random moment.
"""

import math
import os
import pickle
import random
import select
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from attrs import frozen
from campaign import WRONG, Campaign, Verdict

from continuation import Budget, Tracer, trace
from continuation.archive import (
    ArchiveError,
    Limits,
    PathLog,
    export,
    merge,
    open_archive,
    recover,
    resume,
    trace_many,
)  # fmt: skip
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import Cusp, ExponentialCosine

HOMOTOPY = ExponentialCosine(3)
OPTIONS = {"controller": Fixed(bounds=Bounds(initial=0.06))}
SWEEP = [Cusp(splitting) for splitting in np.linspace(0.3, 2.0, 6)]
SHORT = {"budget": Budget(steps=12)}


@frozen
class Child:
    """The result of a process: its answer, its words on stderr, whether it ended in time, its status and its usage."""

    answer: Any
    said: str
    ended: bool
    status: int
    usage: Any


def child(work: Callable[[], object], seconds: float | None = None) -> Child:
    """Do it in a process of its own, with its children; killed after so many seconds if it is not done by then.

    Not in two threads at once: forked processes would wait for each other's locks.
    """
    ours, theirs = os.pipe()
    with tempfile.TemporaryFile("w+") as said, os.fdopen(ours, "rb") as pipe:
        process = os.fork()
        if not process:
            os.setpgid(0, 0)
            os.dup2(said.fileno(), 2)
            try:
                os.write(theirs, pickle.dumps(work()))
                os._exit(0)
            finally:
                os._exit(1)
        os.close(theirs)
        # An answer comes before the end; what raised an exception, or was killed by a signal, gives none, and its own
        # children may keep the pipe open. Not every kernel has `pidfd_open`.
        ended, answered, until = 0, False, math.inf if seconds is None else time.monotonic() + seconds
        while not (ended or answered) and (left := until - time.monotonic()) > 0.0:
            answered = bool(select.select([pipe], [], [], min(left, 0.01))[0])
            ended, status, usage = os.wait4(process, os.WNOHANG)
        in_time = bool(ended) or answered
        if not in_time:
            with suppress(ProcessLookupError):
                os.killpg(process, signal.SIGKILL)
            os.kill(process, signal.SIGKILL)
        if not ended:
            _, status, usage = os.wait4(process, 0)
        os.set_blocking(ours, False)  # Its own children may be there yet.
        raw = pipe.read()
        said.seek(0)
        return Child(pickle.loads(raw) if raw else None, said.read(), in_time, status, usage)


def left_by_a_kill(file: Path, homotopy: Any, steps: int, rows: int, **options: Any) -> Path:
    """An archive whose writer was killed after so many steps, and committed every so many rows."""

    def work() -> None:
        log = PathLog(file, limits=Limits(rows=rows, seconds=3600.0))
        for step in Tracer(homotopy, observers=(log,), **options):
            if step.index == steps:
                os.kill(os.getpid(), signal.SIGKILL)

    assert child(work).status == signal.SIGKILL
    return file


def pooled(file: Path) -> None:
    """A sweep by two processes."""
    with ProcessPoolExecutor(2, mp_context=get_context("fork")) as executor:
        trace_many(SWEEP, executor, file, **SHORT)


class Kills:
    """The files before each operation, the duration of each operation, and the right results."""

    def __init__(self, folder: Path, seed: int = 0) -> None:
        self.folder, self.generator = folder, random.Random(seed)
        self.path = trace(HOMOTOPY, **OPTIONS)
        self.sweep = [trace(homotopy, **SHORT) for homotopy in SWEEP]
        self.half, self.left, self.whole = (folder / name for name in ("half.h5", "left.h5", "whole.h5"))
        steps = len(self.path) // 2
        trace(HOMOTOPY, archive=self.half, budget=Budget(steps=steps), **OPTIONS)
        trace(HOMOTOPY, archive=self.whole, **OPTIONS)
        left_by_a_kill(self.left, HOMOTOPY, steps, 9, **OPTIONS)
        self.seconds: dict[str, float] = {}
        # The file to begin with, and how many of its rows may be missing afterwards: none but those of a block.
        self.begin = {"resume": (self.half, steps), "recover": (self.left, steps - 9), "merge": (self.whole, 0),
                      "export": (self.whole, 0)}  # fmt: skip

    def works(self, file: Path, target: Path) -> dict[str, Callable[[], object]]:
        """Operations on the file, by name."""
        rows = self.generator.choice([1, 4, 30])
        return {
            "trace": lambda: trace(HOMOTOPY, archive=PathLog(file, limits=Limits(rows=rows)), **OPTIONS),
            "resume": lambda: resume(file, budget=Budget()),
            "recover": lambda: recover(file),
            "merge": lambda: merge([file], target),
            "export": lambda: export(file, target),
            "sweep": lambda: trace_many(SWEEP, archive=file, **SHORT),
            "pool": lambda: pooled(file),
        }

    def judge(self, name: str, way: Any) -> Verdict:
        """One kill, at a random moment of the work, and what is found then; the first time it may end."""
        place = self.folder / "case"
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        file, target = place / "run.h5", place / "new.nc"
        if name in self.begin:
            shutil.copy(self.begin[name][0], file)
        known, start = self.seconds.get(name), time.monotonic()
        within = None if known is None else self.generator.uniform(0.0, 1.1 * known)
        work = self.works(file, target)[name]
        # Whether it had a result is all that is sent back.
        ended = child(lambda: work() is not None, within).ended
        # How long it takes changes with what else the machine does.
        self.seconds[name] = time.monotonic() - start if ended else 1.02 * known
        try:
            found = self.found(name, file, target)
        except ArchiveError as error:
            found = f"{WRONG}: unreadable: {error}"
        return found if found.startswith(WRONG) else f"{'ended' if ended else 'killed'}, {found}", np.nan

    def found(self, name: str, file: Path, target: Path) -> str:
        """Check the file after a kill, recover and resume it; a verdict."""
        if name in ("merge", "export"):
            return self.copied(file, target)
        if name in ("sweep", "pool"):
            return self.swept(file)
        if not file.exists():
            return "no file" if name == "trace" else f"{WRONG}: lost"
        with open_archive(file) as archive:
            before = len(archive.path(0)) if len(archive) else 0
            if before and not self.same(archive.path(0)):
                return f"{WRONG}: rows"
        if name in self.begin and before < self.begin[name][1]:
            return f"{WRONG}: lost rows"
        recover(file)
        if not before:
            return "whole without rows"
        with open_archive(file) as archive:
            if archive.path(0).status is self.path.status:
                return "complete"
        again = self.same(resume(file, budget=Budget()), whole=True)
        return "resumed to the same path" if again else f"{WRONG}: resumed to another path"

    def copied(self, file: Path, target: Path) -> str:
        """The source is as it was, and the copy whole, or not there."""
        if file.read_bytes() != self.whole.read_bytes():
            return f"{WRONG}: source changed"
        if not target.exists():
            return "no new file"
        with open_archive(target) as archive:
            whole = archive.closed_by_writer and all(self.same(path, whole=True) for path in archive)
        return "complete" if whole else f"{WRONG}: half-written"

    def same(self, found: Any, *, whole: bool = False) -> bool:
        """Whether a path is the first rows of the right one, or all of it."""
        return starts(found, self.path) and (not whole or found.counts == self.path.counts)

    def swept(self, file: Path) -> str:
        """Every part has right rows, and the sweep runs again."""
        for part in (*file.parent.glob(file.name), *file.parent.glob("run.sweep-*.h5")):
            with open_archive(part) as archive:
                if not all(starts(path, self.sweep[k]) for k, path in zip(archive.paths["member"], archive)):
                    return f"{WRONG}: rows"
        file.unlink(missing_ok=True)
        with trace_many(SWEEP, archive=file, **SHORT) as archive:
            same = len(archive) == len(SWEEP) and all(map(starts, archive, self.sweep))
        return "ran again" if same else f"{WRONG}: ran again otherwise"

    def campaign(self) -> Campaign:
        """A family for each work."""
        return Campaign(
            {name: lambda number, _, name=name: [name] * number for name in self.works(self.folder, self.folder)},
            self.judge,
            {"": None},
        )


def starts(found: Any, path: Any) -> bool:
    """Whether a path is the first points of another, bit by bit."""
    return bool(found.u.tobytes() == path.u[: len(found)].tobytes())


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        sys.exit(Kills(Path(place)).campaign().main(72))
