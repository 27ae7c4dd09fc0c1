"""The archive, measured: memory of a long path; what files, sweeps and columns cost beside none or h5py.

python examples/benchmarks/archive_benchmark.py [memory] [beside] [--points N]
"""

import os
import tempfile
from pathlib import Path

import h5py
import numpy as np
from campaign import asked, timed

from continuation import Budget, Tracer, from_functions, trace
from continuation.archive import PathLog, open_archive, trace_many
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import ExponentialCosine, FreudensteinRoth


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
    path = trace(ExponentialCosine(10), archive=read)

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
        f"a column of {len(path)} points": column,
        "the column by h5py": bare,
    }
    least = dict.fromkeys(jobs, np.inf)
    for _ in range(rounds + 2):
        for name, job in jobs.items():
            least[name] = min(least[name], 1e3 * timed(job)[1])
    for name, milliseconds in least.items():
        share = f", {milliseconds / members:.2f} a path" if "sweep" in name else ""
        print(f"{name}: {milliseconds:.2f} ms{share}")


def _resident() -> float:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


if __name__ == "__main__":
    names, _, options = asked(points=100_000)
    rows = {"memory": lambda folder: memory(folder, options.points), "beside": beside}
    for row in names or rows:
        with tempfile.TemporaryDirectory() as place:
            rows[row](Path(place))
