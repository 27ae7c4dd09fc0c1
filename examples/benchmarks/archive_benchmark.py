"""The archive, measured: cost a step; memory of a long path.

python examples/benchmarks/archive_benchmark.py [cost] [memory] [--points N]
"""

import os
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
from attrs import evolve
from campaign import asked, timed

from continuation import Budget, Step, Tracer, from_functions, trace
from continuation.archive import PathLog
from continuation.controllers import Bounds, Fixed


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


def _resident() -> float:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


if __name__ == "__main__":
    names, _, options = asked(points=100_000)
    with tempfile.TemporaryDirectory() as place:
        if "memory" not in names:
            cost(Path(place))
        if "cost" not in names:
            memory(Path(place), options.points)
