"""Writes the archives of this folder: run it in an environment of commit 10905ca (0.1.0), with a new folder's name.

Finished, out of budget, merged, exported with gzip, a sweep, observed scalars; killed between commits, before the
first, and in the second path of a log. `told.json` is what that version reads from them.
"""

import json
import os
import signal
import sys
from pathlib import Path

import numpy as np

from continuation import Budget, Tracer, trace
from continuation.archive import Limits, PathLog, export, merge, open_archive, trace_many
from problems.bifurcation import Cusp, ExponentialCosine


class Seen:
    target = 1.0

    def start(self):
        return np.zeros(2), 0.0

    def residual(self, y, lam):
        return y - lam

    def jacobian(self, y, lam):
        return np.eye(2), -np.ones(2)

    def observe(self, y, lam):
        return {"norm": float(np.abs(y).max()), "square": float(y @ y)}


def killed(write):
    """Run it in a child that kills itself."""
    child = os.fork()
    if child == 0:
        write()
    os.waitpid(child, 0)


def follow(homotopy, log, steps):
    for index, _ in enumerate(Tracer(homotopy, observers=(log,))):
        if index == steps:
            os.kill(os.getpid(), signal.SIGKILL)


def two_paths():
    with PathLog("killed_sweep.h5", limits=Limits(rows=3)) as log:
        follow(Cusp(), log, -1)
        follow(Cusp(0.4), log, 7)


def told(file):
    with open_archive(file) as archive:
        paths = list(archive)
        return {
            "paths": len(paths),
            "points": archive.points.size,
            "statuses": [path.status.name for path in paths],
            "end": [path.steps[-1].lam if len(path.steps) else None for path in paths],
            "sum": float(archive.points["y"].sum()),
        }


if __name__ == "__main__":
    os.makedirs(sys.argv[1])
    os.chdir(sys.argv[1])
    trace(Cusp(), archive="finished.h5")
    trace(Cusp(), archive="budget.h5", budget=Budget(steps=6))
    trace(Seen(), archive="observed.h5")
    killed(lambda: follow(ExponentialCosine(4), PathLog("killed.h5", limits=Limits(rows=3)), 15))
    killed(lambda: follow(ExponentialCosine(4), PathLog("killed_early.h5"), 15))
    killed(two_paths)
    trace_many([Cusp(0.4), Cusp(0.9), Cusp(1.5)], archive="sweep.h5").close()
    merge(["finished.h5", "budget.h5"], "merged.h5")
    export("finished.h5", "gzip.nc")
    found = {file.name: told(file) for file in sorted(Path().iterdir())}
    Path("told.json").write_text(json.dumps(found, indent=1))
