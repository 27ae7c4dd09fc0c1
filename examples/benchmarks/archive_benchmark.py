"""The archive, measured: cost a step; memory of a long path.

python examples/benchmarks/archive_benchmark.py [cost] [memory] [--points N]
"""

import os
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np
from attrs import evolve
from campaign import asked

from continuation import Budget, Step, Tracer, trace
from continuation.archive import PathLog
from continuation.controllers import Bounds, Fixed


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


if __name__ == "__main__":
    names, _, options = asked(points=100_000)
    with tempfile.TemporaryDirectory() as place:
        if "memory" not in names:
            cost(Path(place))
        if "cost" not in names:
            memory(Path(place), options.points)
