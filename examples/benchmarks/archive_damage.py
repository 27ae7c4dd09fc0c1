"""Damaged archives by the thousand: each operation gives an error or the right data, soon, and in little memory.

python examples/benchmarks/archive_benchmark.py --damage 1000
"""

import gc
import os
import pickle
import random
import resource
import select
import signal
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from continuation import Budget, Tracer, trace
from continuation.archive import ArchiveError, Limits, PathLog, describe, export, merge, open_archive, recover, resume
from continuation.archive.schema import COUNT_NAMES, PATH_COLUMNS
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import ExponentialCosine

HOMOTOPY = ExponentialCosine(3)
OPTIONS = {"controller": Fixed(bounds=Bounds(initial=0.05))}
SECONDS, MEBIBYTES = 5.0, 200
"""What one damaged file may cost, all operations together: seconds of the processor, and memory above the start."""

PAGE = 4096
_OFTEN = 1000
PATHS = {column.name: column.storage for column in PATH_COLUMNS}


def subjects(folder: Path) -> list[Path]:
    """Archives of each kind: closed, left by a kill, of many paths, merged and compressed."""
    closed, killed, many, packed = (folder / name for name in ("closed.h5", "killed.h5", "many.h5", "packed.nc"))
    trace(HOMOTOPY, archive=PathLog(closed, limits=Limits(rows=7), tangents=True), budget=Budget(steps=60), **OPTIONS)
    process = os.fork()
    if not process:
        for step in Tracer(HOMOTOPY, observers=(PathLog(killed, limits=Limits(rows=7)),), **OPTIONS):
            if step.index == 60:
                os.kill(os.getpid(), signal.SIGKILL)
        os._exit(1)
    os.waitpid(process, 0)
    with PathLog(many, limits=Limits(rows=16)) as log:
        for steps in (5, 30, 1, 12):
            trace(HOMOTOPY, archive=log, budget=Budget(steps=steps), **OPTIONS)
    merge([closed, many], folder / "merged.h5")
    export(folder / "merged.h5", packed)
    return [closed, killed, many, packed]


def damaged(files: list[Path], count: int, seed: int) -> Iterator[tuple[str, Path, bytes]]:
    """Kind of damage, file, and the bytes then."""
    generator, whole = random.Random(seed), {file: file.read_bytes() for file in files}
    kinds = ("bit", "bit", "eight bits", "bit of something", "byte", "64 bytes", "page", "pages", "truncation")
    for k in range(count):
        file, kind = files[k % len(files)], kinds[k // len(files) % len(kinds)]
        raw = bytearray(whole[file])
        _damage(raw, kind, generator)
        yield kind, file, bytes(raw)


def _damage(raw: bytearray, kind: str, generator: random.Random) -> None:
    at = generator.randrange(len(raw) - 64)
    if kind in ("bit of something", "byte"):
        while not raw[at]:
            at = generator.randrange(len(raw))
    if kind == "byte":
        raw[at] = generator.choice([0, 127, 128, 255])
    elif kind == "64 bytes":
        raw[at : at + 64] = bytes(64)
    elif kind == "page":
        first = at // PAGE * PAGE
        raw[first : first + PAGE] = bytes(len(raw[first : first + PAGE]))
    elif kind == "pages":
        a, b = (PAGE * generator.randrange(len(raw) // PAGE) for _ in range(2))
        raw[a : a + PAGE], raw[b : b + PAGE] = raw[b : b + PAGE], raw[a : a + PAGE]
    elif kind == "truncation":
        del raw[at:]
    else:
        for _ in range(8 if kind == "eight bits" else 1):
            raw[at] ^= 1 << generator.randrange(8)
            at = generator.randrange(len(raw))


def content(file: Path) -> dict[str, object]:
    """All that an archive says, to be compared."""
    with open_archive(file) as archive:
        return {
            "attributes": {name: np.asarray(value).tobytes() for name, value in archive.attributes.items()},
            "events": archive.event_names,
            "points": {name: archive.points[name].tobytes() for name in archive.points},
            "paths": {name: archive.paths[name].tobytes() for name in archive.paths},
            "problem": _problem(archive),
        }


def _problem(archive) -> tuple[str, dict[str, bytes]]:
    text, arrays = archive.problem()
    return text, {name: array.tobytes() for name, array in arrays.items()}


class Judge:
    """What is right: the content of the file before it was damaged, and the whole path."""

    def __init__(self, file: Path) -> None:
        self.content = content(file)
        self.path = trace(HOMOTOPY, **OPTIONS)
        with open_archive(file) as archive:
            # A few steps more than it has.
            self.budget = Budget(steps=len(archive[-1]) + 4)

    def operations(self, file: Path) -> dict[str, Callable[[], bool]]:
        """Each returns whether what came out is right."""
        again = file.with_name("again.h5")
        return {
            "read": lambda: self._is(content(file)),
            "describe": lambda: bool(_described(file)),
            "resume": lambda: self._follows(resume(file, archive=again, budget=self.budget)),
            "recover": lambda: self._recovered(recover(file)),
        }

    def _is(self, found: dict[str, object]) -> bool:
        # What a path without an end has cost is told by its last checkpoint; without that it is said to be unknown.
        rows, right = dict(found["paths"]), self.content["paths"]
        for name in ("wall_time", *COUNT_NAMES.values()):
            last = np.frombuffer(rows[name], PATHS[name])[-1]
            if last == -1 or np.isnan(last):
                rows[name] = right[name]
        rows["controller_state"] = right["controller_state"]
        return {**found, "paths": rows} == self.content

    def _follows(self, path) -> bool:
        return path.u.tobytes() == self.path.u[: len(path)].tobytes()

    def _recovered(self, file: Path) -> bool:
        with open_archive(file) as archive:
            # Steps only: a path that is cut has no more events than points.
            return all(self._follows(path) for path in archive)


def _described(file: Path) -> str:
    with open_archive(file) as archive:
        archive.checkpoint()
        return describe(archive)


def _verdicts(judge: Judge, file: Path) -> dict[str, str]:
    found = {}
    for name, operation in judge.operations(file).items():
        try:
            found[name] = "right" if operation() else "DIFFERENT"
        except ArchiveError as error:
            found[name] = "error" if "\n" not in str(error) else "ERROR OF MANY LINES"
        except BaseException as error:
            found[name] = f"EXCEPTION {type(error).__name__}: {str(error)[:100]}"
    return found


def case(judge: Judge, file: Path) -> dict[str, str]:
    """The verdicts on one damaged file, by a process of its own."""
    ours, theirs = os.pipe()
    process = os.fork()
    if not process:
        warnings.simplefilter("error")
        gc.freeze()  # What the parent has is not looked through again in each child.
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        found = _verdicts(judge, file)
        used = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) >> 10
        if used > MEBIBYTES:
            found["memory"] = f"{used} MiB"
        os.write(theirs, pickle.dumps(found))
        os._exit(0)
    os.close(theirs)
    # Seconds of the processor: the machine may be busy with something else. One that only waits uses none.
    late = "" if select.select([ours], [], [], 20 * SECONDS)[0] else "HANGS"
    if late:
        os.kill(process, signal.SIGKILL)
    _, status, usage = os.wait4(process, 0)
    if not late and usage.ru_utime + usage.ru_stime > SECONDS:
        late = f"{usage.ru_utime + usage.ru_stime:.1f} s"
    with os.fdopen(ours, "rb") as pipe:
        raw = pipe.read()
    found = pickle.loads(raw) if raw else {}
    if late:
        found["time"] = late
    if os.WIFSIGNALED(status):
        found["process"] = f"SIGNAL {os.WTERMSIG(status)}"
    return found


def damage(folder: Path, count: int, seed: int = 0) -> bool:
    """The campaign; True if nothing went wrong."""
    files = subjects(folder)
    judges = {file: Judge(file) for file in files}
    work, tally, good = folder / "case", Counter(), True
    work.mkdir()
    for k, (kind, file, raw) in enumerate(damaged(files, count, seed)):
        for left in work.iterdir():
            left.unlink()
        subject = work / file.name
        subject.write_bytes(raw)
        for name, verdict in case(judges[file], subject).items():
            tally[name, verdict] += 1
            if verdict not in ("right", "error"):
                good = False
                print(f"  case {k} of seed {seed}, {kind} of {file.name}: {name}: {verdict}", flush=True)
        if k % _OFTEN == _OFTEN - 1:
            print(f"  {k + 1} so far", flush=True)
    print(f"{count} damaged files:")
    for (name, verdict), number in sorted(tally.items()):
        print(f"  {name:<9} {number:6} {verdict}")
    return good
