"""Campaigns: what is tried by the thousand, each of any size, with what is right known beforehand."""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
import resource
import shutil
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import count
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from attrs import frozen

from continuation import Budget, Tracer, from_functions, trace
from continuation.archive import ArchiveError, PathLog, open_archive, recover, resume, trace_many
from continuation.controllers import Bounds, Fixed
from problems import lcp
from problems.bifurcation import Cusp, ExponentialCosine

from ..continuation.archive.util import child, killed, logged, outcome
from ..util import benchmark

HOMOTOPY = ExponentialCosine(3)
OPTIONS: dict[str, Any] = {"controller": Fixed(bounds=Bounds(initial=0.02))}


@frozen
class Found:
    """What a campaign came to: how many were done, how many were wrong, and the figures in one line."""

    done: int
    wrong: int
    text: str


def ran(file: str, make: Callable[[Any, Path], Any], *names: str) -> Callable[[Path, int], Found]:
    """A benchmark's campaign, with as many cases as are asked for in all its families, or those of these names."""

    def run(folder: Path, size: int) -> Found:
        out, campaign = io.StringIO(), make(benchmark(file), folder)
        with contextlib.redirect_stdout(out):
            wrong = campaign.run(max(size // len(names or campaign.families), 1), 0, names)
        return Found(size, wrong, ", ".join(" ".join(line.split()) for line in out.getvalue().splitlines()))

    return run


kills = ran("archive_kills.py", lambda module, folder: module.Kills(folder).campaign())
damage = ran("archive_damage.py", lambda module, folder: module.campaign(folder))


def tally(mode: str) -> Callable[[Path, int], Found]:
    """A mode of the benchmark of units."""
    return ran("claims.py", lambda module, folder: module.CAMPAIGN, mode)


def memory(folder: Path, size: int) -> Found:
    """A long path of which the ends are kept, round and round the unit circle: MiB above the start."""
    spiral = from_functions(
        lambda y, lam: y - (np.cos(lam), np.sin(lam)),
        lambda y, lam: (np.eye(2), np.array([np.sin(lam), -np.cos(lam)])),
        start=([1.0, 0.0], 0.0), target=None,
    )  # fmt: skip
    options = {"controller": Fixed(bounds=Bounds(initial=0.01))}
    trace(spiral, archive=PathLog(folder / "first.h5", keep="ends"), budget=Budget(steps=600), **options)
    begin, most = _resident(), 0.0
    log = PathLog(folder / "long.h5", keep="ends")
    for step in Tracer(spiral, observers=(log,), budget=Budget(steps=size - 1), **options):
        if not step.index % 1000:
            most = max(most, _resident() - begin)
    return Found(size, int(most > 16.0), f"{size} points of 2 unknowns: {most:.1f} MiB above the start at most")


def _resident() -> float:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def _prefix(file: Path, whole: Any, least: int = 0) -> bool:
    """Whether an archive holds the first rows of a path, at least so many, and no others."""
    with open_archive(file) as archive:
        rows = archive.path(0).u if len(archive) else whole.u[:0]
    return len(rows) >= least and rows.tobytes() == whole.u[: len(rows)].tobytes()


def counted(attempts: Callable[[Path, int], Iterator[str]]) -> Callable[[Path, int], Found]:
    """A campaign of attempts, each of which says in words what came of it: of what is wrong the first is WRONG."""

    def campaign(folder: Path, size: int) -> Found:
        seen = Counter(attempts(folder, size))
        wrong = sum(number for what, number in seen.items() if what.startswith("WRONG"))
        return Found(size, wrong, ", ".join(f"{number} {what}" for what, number in seen.most_common()))

    return campaign


@counted
def bad_input(folder: Path, size: int) -> Iterator[str]:
    """Every argument of everything public; the table has one size."""
    from . import hostile

    for call, argument, value in hostile.cases():
        found = hostile.verdict(call, argument, value)
        place = f"{hostile.name_of(call)}({argument}={value!r:.60})"
        yield "refused by name in one line" if found == "refused" else f"WRONG: {place}: {found}"


@counted
def full(folder: Path, size: int) -> Iterator[str]:
    """A quota that is reached while a path is traced: one line, and what was committed can be read."""
    whole_file = folder / "whole.h5"
    whole = trace(HOMOTOPY, archive=logged(whole_file), **OPTIONS)
    needed = whole_file.stat().st_size
    for k in range(size):
        file, limit = folder / f"full{k}.h5", 1_000 + k * (needed - 1_000) // size

        def work(file: Path = file, limit: int = limit) -> str:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            return outcome(lambda file: trace(HOMOTOPY, archive=logged(file), **OPTIONS), file)[0]

        said = child(work).answer
        if said == "":
            yield "there was room"
        elif said is None or "\n" in said:
            yield "WRONG: no ArchiveError of one line"
        elif not file.exists():
            yield "an ArchiveError, no file"
        else:
            recover(file)
            yield "an ArchiveError, and a right file" if _prefix(file, whole) else "WRONG ROWS"


@counted
def growing(folder: Path, size: int) -> Iterator[str]:
    """Opened while it is written: each time the first rows of the path, and never fewer than before."""
    whole, looks = trace(HOMOTOPY, **OPTIONS), count(1)
    for number in count():
        file = folder / f"growing{number}.h5"
        for step in Tracer(HOMOTOPY, observers=(logged(file, 1),), **OPTIONS):
            # By another process, as a reader is; what is behind the step may not be committed yet.
            yield "right" if child(lambda: _prefix(file, whole, step.index)).answer else "WRONG"  # noqa: B023
            if next(looks) == size:
                return


@counted
def resumes(folder: Path, size: int) -> Iterator[str]:
    """Two resumes of one file at once: one goes on, the other is refused, and the file is whole."""
    whole, left = trace(HOMOTOPY, **OPTIONS), killed(folder / "killed.h5", HOMOTOPY, 20, 5, **OPTIONS)
    for k in range(size):
        file = shutil.copy(left, folder / f"two{k}.h5")
        with ProcessPoolExecutor(2, mp_context=get_context("fork")) as pool:
            errors = [future.exception() for future in [pool.submit(resume, file) for _ in range(2)]]
        # Whoever comes when the other is done finds a path that has ended.
        right = "one resumed, one was refused" if _prefix(file, whole, len(whole)) else "WRONG ROWS"
        yield right if {type(error) for error in errors} == {type(None), ArchiveError} else f"WRONG: {errors}"


@counted
def interrupts(folder: Path, size: int) -> Iterator[str]:
    """Ctrl-C in `lcp.solve`: one is enough, wherever it comes, and no path begins after it."""
    residual = lcp.KKTHomotopy.residual
    problem = lcp.LCP([[1.0, -1.0], [-1.0, 1.0]], [-0.5, 2.0])
    calls = lcp.solve(problem, "kkt", restarts=2, finish=False).counts.residuals
    for k in range(size):
        numbers, last = count(1), 1 + k * calls // (2 * size)

        def pressed(self: Any, y: Any, lam: float, numbers: Any = numbers, last: int = last) -> Any:
            if next(numbers) == last:
                raise KeyboardInterrupt
            return residual(self, y, lam)

        lcp.KKTHomotopy.residual = pressed
        try:
            lcp.solve(problem, "kkt", restarts=2, finish=False, archive=folder / f"{k}.h5")
            yield "WRONG: it returned" if next(numbers) > last else "it was done before"
        except KeyboardInterrupt:
            yield "the caller had it" if next(numbers) == last + 1 else "WRONG: it went on"
        finally:
            lcp.KKTHomotopy.residual = residual


def solves(folder: Path, size: int) -> Found:
    """Memory over many solves."""
    rng, used = np.random.default_rng(0), []
    for k in range(size):
        A = rng.standard_normal((3, 3))
        lcp.solve(lcp.LCP(A @ A.T + np.eye(3), rng.standard_normal(3)))
        if k in (size // 4, size - 1):
            used.append(_resident())
    grown = used[1] - used[0]
    return Found(size, int(grown > 4.0), f"{size} solves: {grown:.1f} MiB more after the last than after a quarter")


DIGEST = """
import hashlib, numpy as np
from concurrent.futures import ThreadPoolExecutor
from continuation import FAST, SERIES, Budget, trace
from problems import lcp
from problems.bifurcation import Bratu1D, Cusp, ExponentialCosine, FreudensteinRoth
def one(k):
    rng = np.random.default_rng(k)
    n = 3 + k % 6
    found = lcp.solve(lcp.LCP(rng.standard_normal((n, n)), rng.standard_normal(n)), restarts=3)
    return f"{found.outcome.name} {None if found.x is None else found.x.tobytes().hex()}"
paths = [trace(homotopy, preset=preset, budget=Budget(steps=150)) for preset in (FAST, SERIES)
         for homotopy in (Cusp(), ExponentialCosine(4), FreudensteinRoth(), Bratu1D(60))]
with ThreadPoolExecutor(3) as executor:
    answers = list(executor.map(one, range(20)))
assert answers == [one(k) for k in range(20)]
print(hashlib.sha256("".join([*answers, *(path.u.tobytes().hex() for path in paths)]).encode()).hexdigest())
"""
SURROUNDINGS = (
    {"PYTHONHASHSEED": "0"}, {"PYTHONHASHSEED": "1"}, {"PYTHONHASHSEED": "12345"},
    {"OPENBLAS_NUM_THREADS": "2", "OMP_NUM_THREADS": "2"}, {"PYTHONOPTIMIZE": "1"}, {"PYTHONHASHSEED": "0"},
)  # fmt: skip


def determinism(folder: Path, size: int) -> Found:
    """The same bits for other hash seeds, threads of BLAS, optimisation, and in threads as one after another."""
    digests = [
        subprocess.run(
            [sys.executable, "-c", DIGEST], env={**os.environ, **SURROUNDINGS[k]}, capture_output=True, text=True,
            check=True,
        ).stdout
        for k in range(size)
    ]  # fmt: skip
    wrong = sum(digest != digests[0] for digest in digests)
    seal = hashlib.sha256(digests[0].encode()).hexdigest()[:8]
    return Found(size, wrong, f"8 paths and 20 LCPs, serial and in threads, the same in {size - wrong} runs ({seal})")


@counted
def dask_sweep(folder: Path, size: int) -> Iterator[str]:
    """A sweep over dask: a scheduler, two worker processes, and one of them killed in the middle of a path."""
    from distributed import Client, LocalCluster

    class DiesOnce(Cusp):
        """Pickled by value: workers import nothing from here."""

        def residual(self, y: Any, lam: Any) -> Any:
            marker = os.environ["MARKER"]
            if lam > 0.0 and self.splitting == 1.0 and not os.path.exists(marker):
                open(marker, "w").close()
                os.kill(os.getpid(), signal.SIGKILL)
            return super().residual(y, lam)

    tasks = [DiesOnce(splitting) for splitting in np.linspace(0.5, 2.0, 16)[:15]] + [DiesOnce(1.0)]
    whole = [trace(Cusp(task.splitting)) for task in tasks]
    for k in range(size):
        place, marker = folder / f"sweep{k}", folder / f"died{k}"
        place.mkdir()
        cluster = LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50, env={"MARKER": str(marker)}
        )
        with cluster, Client(cluster) as client, trace_many(tasks, client.get_executor(), place / "run.h5") as paths:
            same = len(paths) == len(whole) and all(a.u.tobytes() == b.u.tobytes() for a, b in zip(paths, whole))
        if not marker.exists():
            yield "WRONG: no worker died"
        elif not same or os.listdir(place) != ["run.h5"]:
            yield "WRONG ROWS, or files left"
        else:
            yield "sweeps of 16 paths, a worker killed, every row right"
