"""Damaged archives by the thousand: each operation gives an error or the right data, soon, and in little memory.

python examples/benchmarks/archive_damage.py [NUMBER] [SEED]
"""

import gc
import random
import resource
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from archive_kills import HOMOTOPY, child, left_by_a_kill, starts
from campaign import WRONG, Campaign, Verdict

from continuation import Budget, trace
from continuation.archive import ArchiveError, Limits, PathLog, describe, export, merge, open_archive, recover, resume
from continuation.archive.schema import COUNT_NAMES, PATH_COLUMNS
from continuation.controllers import Bounds, Fixed

OPTIONS = {"controller": Fixed(bounds=Bounds(initial=0.05))}
SECONDS, MEBIBYTES = 5.0, 200
"""Limits for one damaged file, all operations together: seconds of the processor, and memory above the start."""

PAGE = 4096
PATHS = {column.name: column.storage for column in PATH_COLUMNS}


def subjects(folder: Path) -> list[Path]:
    """Archives of each kind: closed, left by a kill, of many paths, merged and compressed."""
    closed, killed, many, packed = (folder / name for name in ("closed.h5", "killed.h5", "many.h5", "packed.nc"))
    trace(HOMOTOPY, archive=PathLog(closed, limits=Limits(rows=7)), budget=Budget(steps=60), **OPTIONS)
    left_by_a_kill(killed, HOMOTOPY, 60, 7, **OPTIONS)
    with PathLog(many, limits=Limits(rows=16)) as log:
        for steps in (5, 30, 1, 12):
            trace(HOMOTOPY, archive=log, budget=Budget(steps=steps), **OPTIONS)
    merge([closed, many], folder / "merged.h5")
    export(folder / "merged.h5", packed)
    return [closed, killed, many, packed]


def put(raw: bytes, at: int, new: bytes) -> bytes:
    """A file with other bytes in the place of as many."""
    return raw[:at] + new + raw[at + len(new) :]


def anywhere(raw: bytes, generator: random.Random) -> int:
    return generator.randrange(len(raw) - 64)


def something(raw: bytes, generator: random.Random) -> int:
    """The place of a byte that is not zero."""
    return generator.choice([at for at, byte in enumerate(raw) if byte])


def flipped(raw: bytes, at: int, generator: random.Random) -> bytes:
    return put(raw, at, bytes([raw[at] ^ 1 << generator.randrange(8)]))


def page(raw: bytes, generator: random.Random) -> int:
    return PAGE * generator.randrange(len(raw) // PAGE)


def exchanged(raw: bytes, a: int, b: int) -> bytes:
    return put(put(raw, a, raw[b : b + PAGE]), b, raw[a : a + PAGE])


KINDS: dict[str, Callable[[bytes, random.Random], bytes]] = {
    "bit": lambda raw, r: flipped(raw, anywhere(raw, r), r),
    "eight bits": lambda raw, r: reduce(lambda left, _: flipped(left, anywhere(raw, r), r), range(8), raw),
    "bit of something": lambda raw, r: flipped(raw, something(raw, r), r),
    "byte": lambda raw, r: put(raw, something(raw, r), bytes([r.choice([0, 127, 128, 255])])),
    "64 bytes": lambda raw, r: put(raw, anywhere(raw, r), bytes(64)),
    "page": lambda raw, r: put(raw, page(raw, r), bytes(PAGE)),
    "pages": lambda raw, r: exchanged(raw, page(raw, r), page(raw, r)),
    "truncation": lambda raw, r: raw[: anywhere(raw, r)],
}
"""The bytes of a file after a kind of damage."""


def content(file: Path) -> dict[str, object]:
    """The whole content of an archive, for comparison."""
    with open_archive(file) as archive:
        text, arrays = archive.contents.problem()
        tables = {"points": archive.points, "paths": archive.paths, "problem": arrays}
        return {
            "attributes": {name: np.asarray(value).tobytes() for name, value in archive.attributes.items()},
            "events": archive.event_names,
            "text": text,
            **{name: {key: table[key].tobytes() for key in table} for name, table in tables.items()},
        }


class Judge:
    """Compares with the content of the file before it was damaged, and with the whole path."""

    def __init__(self, file: Path) -> None:
        self.raw, self.content, self.path = file.read_bytes(), content(file), trace(HOMOTOPY, **OPTIONS)
        with open_archive(file) as archive:
            # A few steps more than it has.
            self.budget = Budget(steps=len(archive[-1]) + 4)

    def operations(self, file: Path) -> dict[str, Callable[[], bool]]:
        """Each returns whether what came out is right."""
        again = file.with_name("again.h5")
        return {
            "read": lambda: self._is(content(file)),
            "describe": lambda: bool(_described(file)),
            "resume": lambda: starts(resume(file, archive=again, budget=self.budget), self.path),
            "recover": lambda: self._recovered(recover(file)),
        }

    def _is(self, found: dict[str, Any]) -> bool:
        # What a path without an end has cost is told by its last checkpoint; without that it is said to be unknown.
        rows, right = dict(found["paths"]), self.content["paths"]
        for name in ("wall_time", *COUNT_NAMES.values()):
            last = np.frombuffer(rows[name], PATHS[name])[-1]
            if last == -1 or np.isnan(last):
                rows[name] = right[name]
        rows["controller_state"] = right["controller_state"]
        return {**found, "paths": rows} == self.content

    def _recovered(self, file: Path) -> bool:
        with open_archive(file) as archive:
            # Steps only: a path that is cut has no more events than points.
            return all(starts(path, self.path) for path in archive)

    def verdicts(self, file: Path) -> dict[str, str]:
        """The result of each operation, in a new process."""
        warnings.simplefilter("error")
        gc.freeze()  # What the parent has is not looked through again in each child.
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        before, found = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, {}
        for name, operation in self.operations(file).items():
            try:
                found[name] = "right" if operation() else f"{WRONG}: different"
            except ArchiveError as error:
                found[name] = "error" if "\n" not in str(error) else f"{WRONG}: an error of many lines"
            except BaseException as error:
                found[name] = f"{WRONG}: {type(error).__name__}: {str(error)[:100]}"
        used = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) >> 10
        return found | ({"memory": f"{WRONG}: {used} MiB"} if used > MEBIBYTES else {})


def _described(file: Path) -> str:
    with open_archive(file) as archive:
        archive.checkpoint()
        return describe(archive)


def judge(case: tuple[Judge, str, Path], way: Any) -> Verdict:
    """The verdicts on one damaged file, by a process of its own, and its seconds of the processor."""
    right, kind, file = case
    # The machine may be busy with something else; a process that only waits uses nothing.
    done = child(lambda: right.verdicts(file), 20 * SECONDS)
    seconds = done.usage.ru_utime + done.usage.ru_stime
    found = done.answer or {}
    if not done.ended or seconds > SECONDS:
        found["time"] = f"{WRONG}: {seconds:.1f} s" if done.ended else f"{WRONG}: hangs"
    elif done.status:
        found["process"] = f"{WRONG}: status {done.status}"
    bad = [f"{verdict} in {name} of {file.name}, {kind}" for name, verdict in found.items() if WRONG in verdict]
    return bad[0] if bad else ", ".join(f"{name} {verdict}" for name, verdict in found.items()), seconds


def campaign(folder: Path) -> Campaign:
    """Files of each kind, damaged in each way."""

    def cases(number: int, seed: int) -> Iterator[tuple[Judge, str, Path]]:
        files, generator, work = subjects(folder), random.Random(seed), folder / "case"
        judges = [(Judge(file), file.name) for file in files]
        work.mkdir()
        for k in range(number):
            (right, name), kind = judges[k % len(files)], [*KINDS][k // len(files) % len(KINDS)]
            for left in work.iterdir():
                left.unlink()
            (work / name).write_bytes(KINDS[kind](right.raw, generator))
            yield right, kind, work / name

    return Campaign({"damaged files": cases}, judge, {"": None}, "seconds")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        sys.exit(campaign(Path(place)).main(1000))
