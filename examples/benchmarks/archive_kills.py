"""Kills by the thousand: whatever is written, what was committed stays, and a final name means a whole file.

python examples/benchmarks/archive_benchmark.py --kills 500
"""

import os
import random
import select
import shutil
import signal
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np

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


class Campaign:
    """The files to begin with, how long each work takes, and what is right."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.folder, self.generator, self.tally = folder, random.Random(seed), Counter()
        self.path = trace(HOMOTOPY, **OPTIONS)
        self.sweep = [trace(homotopy, **SHORT) for homotopy in SWEEP]
        self.half, self.left, self.whole = (folder / name for name in ("half.h5", "left.h5", "whole.h5"))
        steps = len(self.path) // 2
        trace(HOMOTOPY, archive=self.half, budget=Budget(steps=steps), **OPTIONS)
        trace(HOMOTOPY, archive=self.whole, **OPTIONS)
        process = os.fork()
        if not process:
            for step in Tracer(HOMOTOPY, observers=(PathLog(self.left, limits=Limits(rows=9)),), **OPTIONS):
                if step.index == steps:
                    os.kill(os.getpid(), signal.SIGKILL)
        os.waitpid(process, 0)
        self.seconds: dict[str, float] = {}

    def works(self, file: Path, target: Path) -> dict[str, tuple[Path | None, Callable[[], object]]]:
        """What to begin with, and what to do."""
        rows = self.generator.choice([1, 4, 30])
        return {
            "trace": (None, lambda: trace(HOMOTOPY, archive=PathLog(file, limits=Limits(rows=rows)), **OPTIONS)),
            "resume": (self.half, lambda: resume(file, budget=Budget())),
            "recover": (self.left, lambda: recover(file)),
            "merge": (self.whole, lambda: merge([file], target)),
            "export": (self.whole, lambda: export(file, target)),
            "sweep": (None, lambda: trace_many(SWEEP, archive=file, **SHORT)),
            "pool": (None, lambda: _pooled(file)),
        }

    def kill(self, name: str) -> None:
        """One kill, at a random moment of the work, and what is found then."""
        place = self.folder / "case"
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        file, target = place / "run.h5", place / "new.nc"
        begin, work = self.works(file, target)[name]
        if begin is not None:
            shutil.copy(begin, file)
        if name not in self.seconds:
            # Once to its end, for its length.
            start = time.monotonic()
            _in_child(work, None)
            self.seconds[name] = time.monotonic() - start
            self._note(name, "to its end", self._judge(name, file, target))
            return self.kill(name)
        start = time.monotonic()
        killed = _in_child(work, self.generator.uniform(0.0, 1.1 * self.seconds[name]))
        # How long it takes changes with what else the machine does.
        self.seconds[name] = 1.02 * self.seconds[name] if killed else time.monotonic() - start
        self._note(name, "killed" if killed else "ended before", self._judge(name, file, target))
        return None

    def _note(self, name: str, what: str, verdict: str) -> None:
        self.tally[name, what, verdict] += 1
        if verdict.isupper():
            print(f"  {name}: {verdict}", flush=True)

    def _judge(self, name: str, file: Path, target: Path) -> str:
        try:
            return self._found(name, file, target)
        except ArchiveError as error:
            return f"UNREADABLE: {error}".upper()

    def _found(self, name: str, file: Path, target: Path) -> str:
        if name in ("merge", "export"):
            return self._copied(file, target)
        if name in ("sweep", "pool"):
            return self._swept(file)
        if not file.exists():
            return "no file" if name == "trace" else "LOST"
        with open_archive(file) as archive:
            before = len(archive.path(0)) if len(archive) else 0
            if before and not self._same(archive.path(0)):
                return "WRONG ROWS"
        least = {"resume": len(self.path) // 2, "recover": len(self.path) // 2 - 9, "trace": 0}
        if before < least[name]:
            return "LOST ROWS"
        recover(file)
        if not before:
            return "whole without rows"
        with open_archive(file) as archive:
            if archive.path(0).status is self.path.status:
                return "complete"
        again = resume(file, budget=Budget())
        return "resumed to the same path" if self._same(again, whole=True) else "RESUMED TO ANOTHER PATH"

    def _copied(self, file: Path, target: Path) -> str:
        if file.read_bytes() != self.whole.read_bytes():
            return "SOURCE CHANGED"
        if not target.exists():
            return "no new file"
        with open_archive(target) as archive:
            whole = archive.closed_by_writer and all(self._same(path, whole=True) for path in archive)
        return "complete" if whole else "HALF-WRITTEN"

    def _same(self, found, *, whole: bool = False) -> bool:
        path = self.path
        return found.u.tobytes() == path.u[: len(found)].tobytes() and (not whole or found.counts == path.counts)

    def _swept(self, file: Path) -> str:
        for part in (*file.parent.glob(file.name), *file.parent.glob("run.sweep-*.h5")):
            with open_archive(part) as archive:
                for member, path in zip(archive.paths["member"], archive):
                    if path.u.tobytes() != self.sweep[member].u[: len(path)].tobytes():
                        return "WRONG ROWS"
        file.unlink(missing_ok=True)
        with trace_many(SWEEP, archive=file, **SHORT) as archive:
            same = all(a.u.tobytes() == b.u.tobytes() for a, b in zip(archive, self.sweep))
            return "ran again" if same and len(archive) == len(SWEEP) else "RAN AGAIN OTHERWISE"


def _pooled(file: Path) -> None:
    with ProcessPoolExecutor(2, mp_context=get_context("fork")) as executor:
        trace_many(SWEEP, executor, file, **SHORT)


def _in_child(work: Callable[[], object], seconds: float | None) -> bool:
    """Do it in a process of its own, with its children; killed after so many seconds if it is not done by then."""
    process = os.fork()
    if not process:
        os.setpgid(0, 0)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        try:
            work()
        finally:
            os._exit(0)
    ended = os.pidfd_open(process)
    try:
        if select.select([ended], [], [], seconds)[0]:
            os.waitpid(process, 0)
            return False
    finally:
        os.close(ended)
    try:
        os.killpg(process, signal.SIGKILL)
    except ProcessLookupError:
        os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    return True


def kill(folder: Path, count: int, seed: int = 0) -> bool:
    """The campaign; True if nothing went wrong."""
    campaign = Campaign(folder, seed)
    names = list(campaign.works(folder, folder))
    for k in range(count):
        campaign.kill(names[k % len(names)])
    print(f"{count} kills:")
    for (name, what, verdict), number in sorted(campaign.tally.items()):
        print(f"  {name:<8} {number:6} {what}: {verdict}")
    return not any(verdict.isupper() for _, _, verdict in campaign.tally)
