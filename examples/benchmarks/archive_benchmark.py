"""The archive, measured: cost a step, and of checksums; memory of a long path; small paths; campaigns of kills, damage.

python examples/benchmarks/archive_benchmark.py [cost] [checksums] [memory] [small] [--points N]
    [--kills N] [--damage N] [--seed S]
"""

import argparse
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from archive_damage import damage
from archive_kills import kill
from attrs import evolve

from continuation import Budget, Step, Tracer, trace
from continuation.archive import PathLog, open_archive, store
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import Circle


class Diagonal:
    """A homotopy of any size, for the sake of a tracer."""

    target = None

    def __init__(self, unknowns: int) -> None:
        self.unknowns = unknowns

    def start(self):
        return np.zeros(self.unknowns), 0.0

    def residual(self, y, lam):
        return y - lam

    def jacobian(self, y, lam):
        return np.eye(self.unknowns), -np.ones(self.unknowns)


def cost(folder: Path) -> None:
    """Microseconds a step of the observer alone, in a loop that does nothing else."""
    print("cost a step, microseconds: least and median of 7 runs; processor time")
    for unknowns, steps in ((10, 40_000), (1000, 6_000)):
        for durable in (False, True):
            runs = [_cost(folder / f"{unknowns}{durable}{k}.h5", unknowns, steps, durable) for k in range(7)]
            walls, processor = [run[0] for run in runs], min(run[1] for run in runs)
            print(
                f"  N = {unknowns:<5} {'durable' if durable else 'default':<8} {min(walls):6.1f} "
                f"{statistics.median(walls):6.1f}; {processor:.1f}"
            )


def _cost(file: Path, unknowns: int, steps: int, durable: bool) -> tuple[float, float]:
    tracer = Tracer(Diagonal(unknowns))
    next(iter(tracer))
    points = np.random.default_rng(0).random((steps, unknowns + 1))
    states = [evolve(tracer.state, index=k) for k in range(steps)]
    log = PathLog(file, durable=durable)
    records = [Step(k, points[k], points[k], 0.1 * k, 0.1, 1e-9, 1, 0, 3, 0) for k in range(steps)]
    log.step(tracer, records[0])
    begin, busy = time.perf_counter(), time.process_time()
    for state, record in zip(states[1:], records[1:]):
        tracer.state = state
        log.step(tracer, record)
    seconds, busy = time.perf_counter() - begin, time.process_time() - busy
    log.close()
    file.unlink()
    return 1e6 * seconds / (steps - 1), 1e6 * busy / (steps - 1)


def checksums(folder: Path) -> None:
    """What of that the checksums take: processor time with them and without, by turns."""
    print("cost a step, microseconds of the processor: with checksums, without, their share; least of 9 runs each")
    for unknowns, steps in ((10, 30_000), (1000, 4_000)):
        seals, found = (store.seal, _unsealed), ([], [])
        for k in range(18):
            store.seal = seals[k % 2]
            found[k % 2].append(_cost(folder / "sealed.h5", unknowns, steps, False)[1])
        store.seal = seals[0]
        given, bare = min(found[0]), min(found[1])
        print(f"  N = {unknowns:<5} {given:6.2f} {bare:6.2f}; {100 * (given - bare) / given:.1f} %")


def _unsealed(block, start: int):
    stop = start + len(next(iter(block.values())))
    return np.array([stop & 0xFFFFFFFF, stop >> 32, *[0] * len(block)], dtype="u4")


class Round:
    """Two unknowns on the unit circle, which the parameter goes round without end."""

    target = None

    def start(self):
        return np.array([1.0, 0.0]), 0.0

    def residual(self, y, lam):
        return y - (np.cos(lam), np.sin(lam))

    def jacobian(self, y, lam):
        return np.eye(2), np.array([np.sin(lam), -np.cos(lam)])


def memory(folder: Path, points: int) -> None:
    """MiB above the start while a long path is traced with ``keep="ends"``."""
    options = {"controller": Fixed(bounds=Bounds(initial=0.01))}
    trace(Round(), archive=PathLog(folder / "first.h5", keep="ends"), budget=Budget(steps=600), **options)
    begin, most = _resident(), 0.0
    tracer = Tracer(
        Round(), observers=(PathLog(folder / "long.h5", keep="ends"),), budget=Budget(steps=points - 1), **options
    )
    for step in tracer:
        if not step.index % 1000:
            most = max(most, _resident() - begin)
    size = (folder / "long.h5").stat().st_size / 2**20
    print(f"{len(tracer.path)} points of 2 unknowns: {most:.1f} MiB above the start at most; a file of {size:.0f} MiB")
    middle = tracer.path.steps[points // 2]
    print(f"  one of them, read: lam = {middle.lam:.6f}; {_resident() - begin:.1f} MiB above the start then")


def _resident() -> float:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def small(folder: Path, count: int = 10_000) -> None:
    """Ten thousand small paths in one file: how fast they are written, how large it is, how fast it is read."""
    import xarray  # which takes longer than the smallest campaign

    file = folder / "small.h5"
    options = {"budget": Budget(steps=12)}
    begin = time.perf_counter()
    for _ in range(300):
        trace(Circle(), **options)
    bare = (time.perf_counter() - begin) / 300
    begin = time.perf_counter()
    with PathLog(file) as log:
        for _ in range(count):
            trace(Circle(), archive=log, **options)
    each = (time.perf_counter() - begin) / count
    print(f"{count} paths: {1e3 * each:.2f} ms a path, of which the archive takes {1e3 * (each - bare):.2f} ms")
    with open_archive(file) as archive:
        rows = archive.points.size
    size = file.stat().st_size
    print(f"  {rows} rows, {size / 2**20:.1f} MiB, {size / rows:.0f} bytes a row")
    begin = time.perf_counter()
    archive = open_archive(file)
    opened = time.perf_counter()
    longest = np.bincount(archive.points["path_index"], archive.points["step_length"] > 0)
    grouped = time.perf_counter()
    archive.path(count // 2)
    read = time.perf_counter()
    print(
        f"  ours: open {1e3 * (opened - begin):.1f} ms, group {1e3 * (grouped - opened):.1f} ms, "
        f"one path {1e3 * (read - grouped):.1f} ms; {longest.max():.0f} steps at most"
    )
    archive.close()
    for engine in ("h5netcdf", "netcdf4"):
        begin = time.perf_counter()
        with xarray.open_dataset(file, engine=engine) as data:
            opened = time.perf_counter()
            frame = data[["arclength", "path_index"]].to_dataframe()
            frame.groupby("path_index").arclength.max()
            grouped = time.perf_counter()
        print(
            f"  xarray, {engine}: open {1e3 * (opened - begin):.0f} ms, group by path {1e3 * (grouped - opened):.0f} ms"
        )


PARTS = {"cost": cost, "checksums": checksums, "memory": memory, "small": small}


def main() -> int:
    """What is asked for; the campaigns end with status 1 if anything went wrong."""
    parser = argparse.ArgumentParser(description="The archive, measured.")
    parser.add_argument("parts", nargs="*", help=f"{', '.join(PARTS)}; all of them without a campaign")
    parser.add_argument("--points", type=int, default=100_000, metavar="N", help="of the path that `memory` traces")
    parser.add_argument("--kills", type=int, default=0, metavar="N", help="kill N processes at work with archives")
    parser.add_argument("--damage", type=int, default=0, metavar="N", help="damage N archives")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    campaigns = {"kill": arguments.kills, "damage": arguments.damage}
    good = True
    with tempfile.TemporaryDirectory() as name:
        for part in arguments.parts or ([] if any(campaigns.values()) else PARTS):
            PARTS[part](Path(name), *([arguments.points] if part == "memory" else []))
        for campaign in (kill, damage):
            count = campaigns[campaign.__name__]
            if count:
                folder = Path(name) / campaign.__name__
                folder.mkdir()
                good &= campaign(folder, count, arguments.seed)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
