"""The archive, measured: cost a step; memory of a long path; what files, sweeps and columns cost beside none or h5py.

python examples/benchmarks/archive_benchmark.py [cost] [memory] [beside] [--points N]
"""

import os
import tempfile
from functools import partial
from pathlib import Path

import h5py
import numpy as np
from attrs import evolve
from campaign import asked, timed

from continuation import Budget, Step, Tracer, from_functions, trace
from continuation.archive import PathLog, open_archive, trace_many
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import ExponentialCosine, FreudensteinRoth


def cost(folder: Path) -> None:
    """Microseconds of the processor that a step of the observer alone takes, the least of 7 runs."""
    for unknowns, steps in ((10, 40_000), (1000, 6_000)):
        for durable in (False, True):
            least = min(_cost(folder / f"{unknowns}{durable}{k}.h5", unknowns, steps, durable) for k in range(7))
            print(f"N = {unknowns:<5} {'durable' if durable else 'default':<8} {least:6.1f} us of the processor a step")


def _cost(file: Path, unknowns: int, steps: int, durable: bool) -> float:
    identity, ones = np.eye(unknowns), np.ones(unknowns)
    tracer = Tracer(from_functions(lambda y, lam: y - lam, lambda y, lam: (identity, -ones), start=(0.0 * ones, 0.0)))
    next(iter(tracer))
    points = np.random.default_rng(0).random((steps, unknowns + 1))
    states = [evolve(tracer.state, index=k) for k in range(steps)]
    records = [Step(k, points[k], points[k], 0.1 * k, 0.1, 1e-9, 1, 0, 3, 0) for k in range(steps)]

    def logged(first: int, last: int) -> None:
        for k in range(first, last):
            tracer.state = states[k]
            log.step(tracer, records[k])

    with PathLog(file, durable=durable) as log:
        logged(0, 1)
        _, seconds = timed(partial(logged, 1, steps))
    file.unlink()
    return 1e6 * seconds / (steps - 1)


def memory(folder: Path, points: int) -> None:
    """MiB above the start while a long path is traced with ``keep="ends"``: round and round the unit circle."""
    spiral = from_functions(
        lambda y, lam: y - (np.cos(lam), np.sin(lam)),
        lambda y, lam: (np.eye(2), np.array([np.sin(lam), -np.cos(lam)])),
        start=([1.0, 0.0], 0.0), target=None,
    )  # fmt: skip
    options = {"controller": Fixed(bounds=Bounds(initial=0.01))}
    trace(spiral, archive=PathLog(folder / "first.h5", keep="ends"), budget=Budget(steps=600), **options)
    begin, most = _resident(), 0.0
    log = PathLog(folder / "long.h5", keep="ends")
    tracer = Tracer(spiral, observers=(log,), budget=Budget(steps=points - 1), **options)
    for step in tracer:
        if not step.index % 1000:
            most = max(most, _resident() - begin)
    size = (folder / "long.h5").stat().st_size / 2**20
    print(f"{len(tracer.path)} points of 2 unknowns: {most:.1f} MiB above the start at most; a file of {size:.0f} MiB")
    middle = tracer.path.steps[points // 2]
    print(f"  one of them, read: lam = {middle.lam:.6f}; {_resident() - begin:.1f} MiB above the start then")


def beside(folder: Path, rounds: int = 15, members: int = 60) -> None:
    """Milliseconds of the processor, the least of some rounds in turn: with a file and without, by us and by h5py."""
    names = (folder / f"{k}.h5" for k in range(10 * rounds))
    one, many = FreudensteinRoth(), [FreudensteinRoth() for _ in range(members)]
    read = next(names)
    trace(ExponentialCosine(10), archive=read)

    def column() -> None:
        with open_archive(read) as archive:
            archive.points["y"]

    def bare() -> None:
        with h5py.File(read) as file:
            file["y"][: file["committed_points"][()]]

    jobs = {
        "a trace": lambda: trace(one),
        "a trace with a file": lambda: trace(one, archive=next(names)),
        "a sweep": lambda: trace_many(many),
        "a sweep with a file": lambda: trace_many(many, archive=next(names)).close(),
        "a column": column,
        "a column by h5py": bare,
    }
    least = {name: min(1e3 * timed(job)[1] for _ in range(2)) for name, job in jobs.items()}
    for _ in range(rounds):
        for name, job in jobs.items():
            least[name] = min(least[name], 1e3 * timed(job)[1])
    file, sweep = (least[f"{name} with a file"] - least[name] for name in ("a trace", "a sweep"))
    print(f"a file adds {file:.2f} ms to a trace of {least['a trace']:.2f} ms")
    alone = least["a sweep"] / members
    print(f"a file adds {sweep / members:.2f} ms to a path of {alone:.2f} ms in a sweep of {members}")
    print(f"a column in {least['a column']:.2f} ms, by h5py {least['a column by h5py']:.2f} ms")


def _resident() -> float:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


if __name__ == "__main__":
    names, _, options = asked(points=100_000)
    rows = {"cost": cost, "memory": lambda folder: memory(folder, options.points), "beside": beside}
    for row in names or rows:
        with tempfile.TemporaryDirectory() as place:
            rows[row](Path(place))
